within Sigmahat.Examples;
model Table1 "Table I: the stiffness of the AwAS, estimated from encoders and motor torque"
  extends Awas;
  Estimators.StiffnessEstimator estimator annotation (Placement(transformation(extent={{40,-20},{80,20}})));
  Real error(unit="1") "Relative error of the estimate";
equation
  connect(plant.theta_measured, estimator.theta) annotation (Line(points={{2,16},{36,16}}, color={0,0,127}));
  connect(plant.q_measured, estimator.q) annotation (Line(points={{2,10},{18,10},{18,8},{36,8}}, color={0,0,127}));
  connect(plant.theta_c_measured, estimator.theta_c) annotation (Line(points={{2,4},{18,4},{18,0},{36,0}}, color={0,0,127}));
  connect(plant.tau_measured, estimator.tau) annotation (Line(points={{2,-2},{18,-2},{18,-8},{36,-8}}, color={0,0,127}));
  connect(plant.tau_e_measured, estimator.tau_e_sensor)
    annotation (Line(points={{2,-8},{14,-8},{14,-16},{36,-16}}, color={0,0,127}));
  error = (estimator.sigma - plant.sigma)/plant.sigma;
  annotation (
    experiment(StartTime=0, StopTime=15, Interval=0.001, Tolerance=1e-9),
    Documentation(info="<html>
<p>The simulation of section VI.B, estimator RESIDUAL, which needs no torque sensor. Plot <code>plant.sigma</code> and
<code>estimator.sigma</code>: after about a second the estimate follows the stiffness, with an error of about 1 %.</p>
<p>Change <code>estimator.modality</code> to Sensor for an estimate from the torque sensor, <code>estimator.method</code> to FilteredRegression for the
second method.</p>
</html>"));
end Table1;
