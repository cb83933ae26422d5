within Sigmahat.Examples;
model Antagonistic "The stiffness of an antagonistic joint, estimated on both sides"
  extends Icons.Example;
  Plants.AntagonisticVsaPlant plant(init(theta_1=-0.81543848, theta_2=0.91108241))
    annotation (Placement(transformation(extent={{-40,-20},{0,20}})));
  Estimators.AntagonisticStiffnessEstimator estimator(rls(P_0=1e24, m=1))
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
  Sources.Sine pull(amplitude=0.025, frequency=0.1) "Co-contraction, added to its mean of 0.04 N.m"
    annotation (Placement(transformation(extent={{-90,20},{-70,40}})));
  Sources.Sine move(amplitude=0.012, frequency=0.25) "Motion of the link"
    annotation (Placement(transformation(extent={{-90,-20},{-70,0}})));
equation
  plant.tau_1 = -0.04 - pull.y + move.y;
  plant.tau_2 = 0.04 + pull.y + move.y;
  plant.tau_ext = 0;
  connect(plant.theta_measured_1, estimator.theta_1) annotation (Line(points={{2,18},{38,18}}, color={0,0,127}));
  connect(plant.theta_measured_2, estimator.theta_2)
    annotation (Line(points={{2,13},{18,13},{18,12},{38,12}}, color={0,0,127}));
  connect(plant.q_measured, estimator.q) annotation (Line(points={{2,8},{18,8},{18,6},{38,6}}, color={0,0,127}));
  connect(plant.tau_measured_1, estimator.tau_1) annotation (Line(points={{2,3},{18,3},{18,0},{38,0}}, color={0,0,127}));
  connect(plant.tau_measured_2, estimator.tau_2) annotation (Line(points={{2,-2},{18,-2},{18,-6},{38,-6}}, color={0,0,127}));
  connect(plant.tau_e_measured_1, estimator.tau_e_sensor_1)
    annotation (Line(points={{2,-7},{16,-7},{16,-12},{38,-12}}, color={0,0,127}));
  connect(plant.tau_e_measured_2, estimator.tau_e_sensor_2)
    annotation (Line(points={{2,-12},{14,-12},{14,-18},{38,-18}}, color={0,0,127}));
  annotation (
    experiment(StartTime=0, StopTime=30, Interval=0.001, Tolerance=1e-9),
    Documentation(info="<html>
<p>Slow co-contraction under a moving link. Plot <code>plant.sigma</code> and <code>estimator.sigma</code>.</p>
</html>"));
end Antagonistic;
