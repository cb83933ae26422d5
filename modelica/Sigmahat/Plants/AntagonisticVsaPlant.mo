within Sigmahat.Plants;
model AntagonisticVsaPlant
  "A robot joint between two antagonistic motors with nonlinear transmissions, with encoders and noisy torque sensors"
  extends Icons.Antagonists;
  import Sigmahat.Constants.v_coulomb;

  parameter Parameters.Link link(M=0.02, D_q=0.05, mgl=0.5) "Link" annotation (Dialog(group="Joint"));
  parameter Parameters.Motor motor_1 "Motor 1" annotation (Dialog(group="Joint"));
  parameter Parameters.Motor motor_2 "Motor 2" annotation (Dialog(group="Joint"));
  parameter Parameters.ExponentialSpring spring_1(k=0.0026, a=8.9995) "Transmission 1"
    annotation (Dialog(group="Joint"));
  parameter Parameters.ExponentialSpring spring_2(k=0.0011, a=8.9989) "Transmission 2"
    annotation (Dialog(group="Joint"));
  parameter Parameters.AntagonisticEncoders encoder "Encoders" annotation (Dialog(group="Measurement"));
  parameter Parameters.Sensor sensor "Sensors of the flexibility torques" annotation (Dialog(group="Measurement"));
  parameter Parameters.InitialAntagonistic init "Initial state" annotation (Dialog(group="Start"));
  replaceable function drawNoise = standardNormal constrainedby partialNoise "What draws the noise";
  TorqueNoise noise(final side=1, redeclare function drawNoise = drawNoise) "Noise of the measured torques"
    annotation (Placement(transformation(extent={{-10,-90},{10,-70}})));

  Interfaces.RealInput tau_1(final unit="N.m") "Torque of the motor 1, on the motor axis"
    annotation (Placement(transformation(extent={{-140,40},{-100,80}})));
  Interfaces.RealInput tau_2(final unit="N.m") "Torque of the motor 2, on the motor axis"
    annotation (Placement(transformation(extent={{-140,-20},{-100,20}})));
  Interfaces.RealInput tau_ext(final unit="N.m") "External torque on the link"
    annotation (Placement(transformation(extent={{-140,-80},{-100,-40}})));

  Interfaces.RealOutput theta_measured_1(final unit="rad") "Position of the motor 1, from its encoder"
    annotation (Placement(transformation(extent={{100,80},{120,100}})));
  Interfaces.RealOutput theta_measured_2(final unit="rad") "Position of the motor 2, from its encoder"
    annotation (Placement(transformation(extent={{100,55},{120,75}})));
  Interfaces.RealOutput q_measured(final unit="rad") "Position of the link, from its encoder"
    annotation (Placement(transformation(extent={{100,30},{120,50}})));
  Interfaces.RealOutput tau_measured_1(final unit="N.m") "Torque of the motor 1 with noise, (32)"
    annotation (Placement(transformation(extent={{100,5},{120,25}})));
  Interfaces.RealOutput tau_measured_2(final unit="N.m") "Torque of the motor 2 with noise, (32)"
    annotation (Placement(transformation(extent={{100,-20},{120,0}})));
  Interfaces.RealOutput tau_e_measured_1(final unit="N.m")
    "Flexibility torque as its sensor shows it, with gain and noise, (33)"
    annotation (Placement(transformation(extent={{100,-45},{120,-25}})));
  Interfaces.RealOutput tau_e_measured_2(final unit="N.m")
    "Flexibility torque as its sensor shows it, with gain and noise, (33)"
    annotation (Placement(transformation(extent={{100,-70},{120,-50}})));
  Interfaces.RealOutput sigma(final unit="N.m/rad") "Stiffness of the device, sigma_1 + sigma_2"
    annotation (Placement(transformation(extent={{100,-95},{120,-75}})));

  output Types.Angle q(start=init.q, fixed=true) "Position of the link";
  output Types.AngularVelocity q_dot(start=init.q_dot, fixed=true) "Velocity of the link";
  output Types.Angle theta_1(start=init.theta_1, fixed=true) "Position of the motor 1, after its gear";
  output Types.AngularVelocity theta_dot_1(start=init.theta_dot_1, fixed=true) "Velocity of the motor 1, after its gear";
  output Types.Angle theta_2(start=init.theta_2, fixed=true) "Position of the motor 2, after its gear";
  output Types.AngularVelocity theta_dot_2(start=init.theta_dot_2, fixed=true) "Velocity of the motor 2, after its gear";
  output Types.Angle phi_1 "Deformation of the transmission, q - theta_1";
  output Types.Angle phi_2 "Deformation of the transmission, q - theta_2";
  output Types.Torque tau_e_1 "Flexibility torque, k sinh(a phi)";
  output Types.Torque tau_e_2 "Flexibility torque, k sinh(a phi)";
  output Types.Stiffness sigma_1 "Stiffness, k a cosh(a phi), (4)";
  output Types.Stiffness sigma_2 "Stiffness, k a cosh(a phi), (4)";

protected
  TorqueNoise noise_2(
    final side=2,
    final tau_variance=noise.tau_variance,
    final tau_e_variance=noise.tau_e_variance,
    final seed=noise.seed,
    final samplePeriod=noise.samplePeriod,
    redeclare function drawNoise = drawNoise) "Noise of motor 2, with the parameters of noise"
    annotation (Placement(transformation(extent={{20,-90},{40,-70}})));
equation
  // Transmissions
  phi_1 = q - theta_1;
  phi_2 = q - theta_2;
  tau_e_1 = spring_1.k*sinh(spring_1.a*phi_1);
  tau_e_2 = spring_2.k*sinh(spring_2.a*phi_2);
  sigma_1 = spring_1.k*spring_1.a*cosh(spring_1.a*phi_1); // (4)
  sigma_2 = spring_2.k*spring_2.a*cosh(spring_2.a*phi_2); // (4)
  sigma = sigma_1 + sigma_2;

  // Link, (2)
  der(q) = q_dot;
  link.M*der(q_dot) + link.D_q*q_dot + link.tau_coulomb*tanh(q_dot/v_coulomb) + tau_e_1 + tau_e_2
    + link.mgl*sin(q) = tau_ext;

  // Motors, (3)
  der(theta_1) = theta_dot_1;
  motor_1.B*motor_1.gamma*der(theta_dot_1) + motor_1.D_theta*motor_1.gamma*theta_dot_1
    + motor_1.tau_coulomb*tanh(theta_dot_1/v_coulomb) - tau_e_1/motor_1.gamma = tau_1;
  der(theta_2) = theta_dot_2;
  motor_2.B*motor_2.gamma*der(theta_dot_2) + motor_2.D_theta*motor_2.gamma*theta_dot_2
    + motor_2.tau_coulomb*tanh(theta_dot_2/v_coulomb) - tau_e_2/motor_2.gamma = tau_2;

  // Measurements, (32), (33)
  q_measured = rounded(q, encoder.q);
  theta_measured_1 = rounded(theta_1, encoder.theta_1);
  theta_measured_2 = rounded(theta_2, encoder.theta_2);
  tau_measured_1 = tau_1 + noise.tau;
  tau_measured_2 = tau_2 + noise_2.tau;
  tau_e_measured_1 = sensor.gain*tau_e_1 + noise.tau_e;
  tau_e_measured_2 = sensor.gain*tau_e_2 + noise_2.tau_e;

  annotation (Documentation(info="<html>
<p>A link between two motors, agonist and antagonist (section II). The transmissions are those of the qbmove Advanced:
&quot;qbmove Advanced Kit&quot;, qbrobotics, 28 April 2021, section 3.2.2. Its manual gives no inertias, gears and friction: the motors have
those of the AwAS, the values of the link are chosen.</p>
<p>At the start the springs are not deformed. With torques tau_1 = -tau_2 a pair is at rest at q = 0 for
<code>init.theta_i</code> = asinh(gamma tau_i / k_i) / a_i.</p>
</html>"));
end AntagonisticVsaPlant;
