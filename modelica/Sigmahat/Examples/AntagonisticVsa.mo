within Sigmahat.Examples;
model AntagonisticVsa "Two antagonistic motors"
  extends Icons.Example;
  Plants.AntagonisticVsaPlant plant annotation (Placement(transformation(extent={{0,-20},{40,20}})));
  Sources.Sine tau_1(amplitude=0.03, frequency=0.5) "Torque of motor 1"
    annotation (Placement(transformation(extent={{-80,20},{-60,40}})));
  Sources.Sine tau_2(amplitude=0.02, frequency=0.3) "Torque of motor 2"
    annotation (Placement(transformation(extent={{-80,-20},{-60,0}})));
equation
  connect(tau_1.y, plant.tau_1) annotation (Line(points={{-59,30},{-30,30},{-30,12},{-4,12}}, color={0,0,127}));
  connect(tau_2.y, plant.tau_2) annotation (Line(points={{-59,-10},{-30,-10},{-30,0},{-4,0}}, color={0,0,127}));
  plant.tau_ext = 0;
  annotation (
    experiment(StartTime=0, StopTime=15, Interval=0.001, Tolerance=1e-9),
    Documentation(info="<html>
<p>The stiffness <code>plant.sigma</code> of the device is the sum of those of its two transmissions.</p>
</html>"));
end AntagonisticVsa;
