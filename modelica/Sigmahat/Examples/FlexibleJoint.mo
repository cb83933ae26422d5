within Sigmahat.Examples;
model FlexibleJoint "A hardening transmission"
  extends Icons.Example;
  Plants.FlexibleJointPlant plant(spring(k_3=3000)) annotation (Placement(transformation(extent={{0,-20},{40,20}})));
  Sources.Sine tau(amplitude=0.3, frequency=0.5) "Torque of the motor"
    annotation (Placement(transformation(extent={{-80,2},{-60,22}})));
equation
  connect(tau.y, plant.tau) annotation (Line(points={{-59,12},{-4,12}}, color={0,0,127}));
  plant.tau_ext = 0;
  annotation (
    experiment(StartTime=0, StopTime=15, Interval=0.001, Tolerance=1e-9),
    Documentation(info="<html><p>The stiffness <code>plant.sigma</code> is 150 N.m/rad without deformation and grows with it.</p></html>"));
end FlexibleJoint;
