within Sigmahat;
package Constants "Numbers"
  extends Icons.Package;

  final constant Real pi = 3.141592653589793;

  final constant Types.AngularVelocity v_coulomb = 0.02
    "Coulomb friction is smooth: tau_coulomb tanh(velocity / v_coulomb)";

  annotation (Documentation(info="<html>
<p>Coulomb friction is smooth around a velocity of 0: a joint that would stick creeps instead, at <code>v_coulomb</code> under 76 % of the
friction torque.</p>
</html>"));
end Constants;
