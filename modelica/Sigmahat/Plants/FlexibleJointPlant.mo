within Sigmahat.Plants;
model FlexibleJointPlant
  "A robot joint with a single flexible transmission, linear or hardening, with encoders and noisy torque sensors"
  extends Icons.Joint;
  import Sigmahat.Constants.v_coulomb;

  parameter Parameters.Link link "Link" annotation (Dialog(group="Joint"));
  parameter Parameters.Motor motor "Motor" annotation (Dialog(group="Joint"));
  parameter Parameters.HardeningSpring spring "Transmission" annotation (Dialog(group="Joint"));
  parameter Parameters.Encoders encoder "Encoders" annotation (Dialog(group="Measurement"));
  parameter Parameters.Sensor sensor "Sensor of the flexibility torque" annotation (Dialog(group="Measurement"));
  parameter Parameters.InitialJoint init "Initial state" annotation (Dialog(group="Start"));
  replaceable function drawNoise = standardNormal constrainedby partialNoise "What draws the noise";
  TorqueNoise noise(final side=1, redeclare function drawNoise = drawNoise) "Noise of the measured torques"
    annotation (Placement(transformation(extent={{-10,-90},{10,-70}})));

  Interfaces.RealInput tau(final unit="N.m") "Torque of the motor, on the motor axis"
    annotation (Placement(transformation(extent={{-140,40},{-100,80}})));
  Interfaces.RealInput tau_ext(final unit="N.m") "External torque on the link"
    annotation (Placement(transformation(extent={{-140,-80},{-100,-40}})));

  Interfaces.RealOutput theta_measured(final unit="rad") "Position of the motor, from its encoder"
    annotation (Placement(transformation(extent={{100,70},{120,90}})));
  Interfaces.RealOutput q_measured(final unit="rad") "Position of the link, from its encoder"
    annotation (Placement(transformation(extent={{100,40},{120,60}})));
  Interfaces.RealOutput tau_measured(final unit="N.m") "Torque of the motor with noise, (32)"
    annotation (Placement(transformation(extent={{100,-10},{120,10}})));
  Interfaces.RealOutput tau_e_measured(final unit="N.m")
    "Flexibility torque as its sensor shows it, with gain and noise, (33)"
    annotation (Placement(transformation(extent={{100,-40},{120,-20}})));
  Interfaces.RealOutput sigma(final unit="N.m/rad") "Stiffness, k_1 + 3 k_3 phi^2, (4)"
    annotation (Placement(transformation(extent={{100,-90},{120,-70}})));

  output Types.Angle q(start=init.q, fixed=true) "Position of the link";
  output Types.AngularVelocity q_dot(start=init.q_dot, fixed=true) "Velocity of the link";
  output Types.Angle theta(start=init.theta, fixed=true) "Position of the motor, after its gear";
  output Types.AngularVelocity theta_dot(start=init.theta_dot, fixed=true) "Velocity of the motor, after its gear";
  output Types.Angle phi "Deformation of the transmission, q - theta";
  output Types.Torque tau_e "Flexibility torque, k_1 phi + k_3 phi^3";

equation
  // Transmission
  phi = q - theta;
  tau_e = spring.k_1*phi + spring.k_3*phi^3;
  sigma = spring.k_1 + 3*spring.k_3*phi^2; // (4)

  // Link, (2)
  der(q) = q_dot;
  link.M*der(q_dot) + link.D_q*q_dot + link.tau_coulomb*tanh(q_dot/v_coulomb) + tau_e + link.mgl*sin(q) = tau_ext;

  // Motor, (3)
  der(theta) = theta_dot;
  motor.B*motor.gamma*der(theta_dot) + motor.D_theta*motor.gamma*theta_dot
    + motor.tau_coulomb*tanh(theta_dot/v_coulomb) - tau_e/motor.gamma = tau;

  // Measurements, (32), (33)
  q_measured = rounded(q, encoder.q);
  theta_measured = rounded(theta, encoder.theta);
  tau_measured = tau + noise.tau;
  tau_e_measured = sensor.gain*tau_e + noise.tau_e;

  annotation (Documentation(info="<html>
<p>The link (2) hangs on one spring, which a motor (3) moves through a gear. The spring is linear with <code>spring.k_3</code> = 0, the start
value.</p>
</html>"));
end FlexibleJointPlant;
