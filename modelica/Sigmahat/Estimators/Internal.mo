within Sigmahat.Estimators;
package Internal "Calls of the C library"
  extends Icons.Package;

  class Estimator "State of an estimator, in C"
    extends ExternalObject;

    impure function constructor "Checks the parameters, and starts the estimator"
      extends Icons.Function;
      input Types.Time samplePeriod;
      input Types.Method method;
      input Types.Modality modality;
      input Types.Deformation deformation;
      input Types.FilterKind filterKind;
      input Types.Weighting weighting;
      input Types.RlsKind rlsKind;
      input Boolean symmetric;
      input Integer n;
      input Integer m;
      input Boolean held;
      input Real relativeStd;
      input Real motor[3] "B, D_theta, gamma";
      input Real K_I;
      input Real filter[6] "V_a, V_max, V_min, alpha, R, P_0";
      input Real encoder[2] "theta, q";
      input Real setPoint[2] "offset, scale";
      input Real rls[3] "P_0, c, a";
      input Real eta_0[8, 5];
      input Real nominal[3] "k_s, r_0, b";
      input Real noise[2] "tau, tau_e";
      input Real regression[4] "bandwidth, slow, drift, memory";
      input Real range[2] "phi, setPoint";
      input Real prior[16] "In the order of Parameters.Prior";
      output Estimator estimator;

      external "C" estimator = sigmahat_estimator_new(samplePeriod, method, modality, deformation, filterKind,
        weighting, rlsKind, symmetric, n, m, held, relativeStd, motor, K_I, filter, encoder, setPoint, rls, eta_0,
        nominal, noise, regression, range, prior)
        annotation (
          Include="#include \"sigmahat_estimator_new.c\"",
          IncludeDirectory="modelica://Sigmahat/Resources/C-Sources");
      annotation (Documentation(info="<html><p>Ends the simulation if a parameter is out of its range.</p></html>"));
    end constructor;

    impure function destructor "Frees the memory"
      extends Icons.Function;
      input Estimator estimator;

      external "C" sigmahat_estimator_free(estimator)
        annotation (
          Include="#include \"sigmahat_estimator_free.c\"",
          IncludeDirectory="modelica://Sigmahat/Resources/C-Sources");
      annotation (Documentation(info="<html><p>Called by the tool at the end.</p></html>"));
    end destructor;

    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={Ellipse(
            extent={{-100,100},{100,-100}},
            lineColor={29,53,87},
            fillColor={29,53,87},
            fillPattern=FillPattern.Solid)}),
      Documentation(info="<html><p>Parameters and state of one estimator.</p></html>"));
  end Estimator;

  impure function tick "Runs one tick"
    extends Icons.Function;
    input Estimator estimator;
    input Types.Time t "Time: a second call at the same time replaces the first";
    input Types.Angle theta;
    input Types.Angle q;
    input Types.Angle theta_c;
    input Types.Torque tau;
    input Types.Torque tau_e_sensor;
    output Types.Stiffness sigma;
    output Types.Torque tau_e;
    output Types.Torque tau_e_residual;
    output Types.AngularVelocity theta_dot;
    output Types.Angle phi;
    output Types.Ratio setPoint;
    output Types.Ratio a;
    output Types.Ratio rho;
    output Types.Torque epsilon;
    output Real eta[8, 5];
    output Types.Stiffness sigma_std;
    output Types.Torque tau_e_std;
    output Types.Friction D_theta_hat;
    output Types.Inertia B_hat;
    output Types.Torque tau_coulomb_hat;
    output Types.Ratio misfit;
    output Types.Torque bias_hat;
    output Types.Friction damping_hat;
    output Types.Ratio load_friction_hat;
    output Types.Angle eccentric_hat;
    output Types.Time delay_hat;
    output Types.Torque hysteresis_hat;
    output Types.Ratio sigma_per_gain;
    output Types.Doubt doubt;
    output Boolean confident;
    output Boolean valid;

    external "C" sigmahat_estimator_tick(estimator, t, theta, q, theta_c, tau, tau_e_sensor, sigma, tau_e,
      tau_e_residual, theta_dot, phi, setPoint, a, rho, epsilon, eta, sigma_std, tau_e_std, D_theta_hat, B_hat, tau_coulomb_hat,
      misfit, bias_hat, damping_hat, load_friction_hat, eccentric_hat, delay_hat, hysteresis_hat, sigma_per_gain,
      doubt, confident, valid)
      annotation (
        Include="#include \"sigmahat_estimator_tick.c\"",
        IncludeDirectory="modelica://Sigmahat/Resources/C-Sources");
    annotation (Documentation(info="<html>
<p>Inputs and outputs are those of <a href=\"modelica://Sigmahat.Estimators.StiffnessEstimator\">StiffnessEstimator</a>.</p>
</html>"));
  end tick;

  annotation (Documentation(info="<html><p>Not for users: use the blocks.</p></html>"));
end Internal;
