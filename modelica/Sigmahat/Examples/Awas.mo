within Sigmahat.Examples;
model Awas "The AwAS under the torques of Table I"
  extends Icons.Example;
  Plants.AwasPlant plant annotation (Placement(transformation(extent={{-40,-20},{0,20}})));
  Sources.Sine tau(amplitude=0.3, frequency=0.1) "Torque of the principal motor"
    annotation (Placement(transformation(extent={{-90,20},{-70,40}})));
  Sources.Sine tau_c(amplitude=8, frequency=0.1) "Torque of the secondary motor"
    annotation (Placement(transformation(extent={{-90,-20},{-70,0}})));
equation
  connect(tau.y, plant.tau) annotation (Line(points={{-69,30},{-56,30},{-56,12},{-44,12}}, color={0,0,127}));
  connect(tau_c.y, plant.tau_c) annotation (Line(points={{-69,-10},{-56,-10},{-56,0},{-44,0}}, color={0,0,127}));
  plant.tau_ext = 0;
  annotation (
    experiment(StartTime=0, StopTime=15, Interval=0.001, Tolerance=1e-9),
    Documentation(info="<html>
<p>Section VI.B: the lever arm <code>plant.r</code> begins at 70 mm, and the stiffness <code>plant.sigma</code> follows it.</p>
</html>"));
end Awas;
