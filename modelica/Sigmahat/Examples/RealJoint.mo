within Sigmahat.Examples;
model RealJoint "A joint with the defects of real ones"
  extends Icons.Example;
  Plants.RealJointPlant plant(
    motor(tau_coulomb=0.02, uneven=0.1, stribeck=0.3, load_friction=0.03, v_bend=2, cogging=0.005),
    gear(kinematic_error=1e-4),
    spring(damping=1e-3, dahl=0.5, gap=1e-3),
    encoder(q_eccentricity=3e-4, q_offset=1e-3, theta_eccentricity=1e-4),
    sensor(tau_gain=1.02, tau_bias=0.002)) annotation (Placement(transformation(extent={{0,-20},{40,20}})));
  Sources.Sine tau(amplitude=0.3, frequency=0.5) "Torque of the motor"
    annotation (Placement(transformation(extent={{-80,6},{-60,26}})));
equation
  connect(tau.y, plant.tau) annotation (Line(points={{-59,16},{-4,16}}, color={0,0,127}));
  plant.r = 0.07;
  plant.D_theta_change = 0;
  plant.tau_coulomb_change = 0;
  plant.tau_ext = 0;
  annotation (
    experiment(StartTime=0, StopTime=15, Interval=0.001, Tolerance=1e-9),
    Documentation(info="<html>
<p>Plot <code>plant.tau_e</code> over <code>plant.phi</code>: dead zone, loop of the hysteresis, damping.</p>
</html>"));
end RealJoint;
