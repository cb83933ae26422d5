within Sigmahat.Plants;
model AwasPlant
  "The AwAS, an actuator with serial adjustable stiffness, with encoders and noisy torque sensors"
  extends Icons.Lever;
  import Sigmahat.Constants.v_coulomb;

  parameter Parameters.Link link "Link" annotation (Dialog(group="Joint"));
  parameter Parameters.Motor motor "Principal motor" annotation (Dialog(group="Joint"));
  parameter Parameters.SecondaryMotor motor_c "Secondary motor, which moves the lever arm"
    annotation (Dialog(group="Joint"));
  parameter Parameters.LeverSpring spring "Transmission" annotation (Dialog(group="Joint"));
  parameter Parameters.AwasEncoders encoder "Encoders" annotation (Dialog(group="Measurement"));
  parameter Parameters.Sensor sensor "Sensor of the flexibility torque" annotation (Dialog(group="Measurement"));
  parameter Parameters.InitialAwas init "Initial state" annotation (Dialog(group="Start"));
  replaceable function drawNoise = standardNormal constrainedby partialNoise "What draws the noise";
  TorqueNoise noise(final side=1, redeclare function drawNoise = drawNoise) "Noise of the measured torques"
    annotation (Placement(transformation(extent={{-10,-90},{10,-70}})));

  Interfaces.RealInput tau(final unit="N.m") "Torque of the principal motor, on the motor axis"
    annotation (Placement(transformation(extent={{-140,40},{-100,80}})));
  Interfaces.RealInput tau_c(final unit="N.m") "Torque of the secondary motor, on the motor axis"
    annotation (Placement(transformation(extent={{-140,-20},{-100,20}})));
  Interfaces.RealInput tau_ext(final unit="N.m") "External torque on the link"
    annotation (Placement(transformation(extent={{-140,-80},{-100,-40}})));

  Interfaces.RealOutput theta_measured(final unit="rad") "Position of the principal motor, from its encoder"
    annotation (Placement(transformation(extent={{100,70},{120,90}})));
  Interfaces.RealOutput q_measured(final unit="rad") "Position of the link, from its encoder"
    annotation (Placement(transformation(extent={{100,40},{120,60}})));
  Interfaces.RealOutput theta_c_measured(final unit="rad") "Position of the secondary motor, from its encoder"
    annotation (Placement(transformation(extent={{100,10},{120,30}})));
  Interfaces.RealOutput tau_measured(final unit="N.m") "Torque of the principal motor with noise, (32)"
    annotation (Placement(transformation(extent={{100,-20},{120,0}})));
  Interfaces.RealOutput tau_e_measured(final unit="N.m")
    "Flexibility torque as its sensor shows it, with gain and noise, (33)"
    annotation (Placement(transformation(extent={{100,-50},{120,-30}})));
  Interfaces.RealOutput sigma(final unit="N.m/rad") "Stiffness, (29)"
    annotation (Placement(transformation(extent={{100,-90},{120,-70}})));

  output Types.Angle q(start=init.q, fixed=true) "Position of the link";
  output Types.AngularVelocity q_dot(start=init.q_dot, fixed=true) "Velocity of the link";
  output Types.Angle theta(start=init.theta, fixed=true) "Position of the principal motor, after its gear";
  output Types.AngularVelocity theta_dot(start=init.theta_dot, fixed=true)
    "Velocity of the principal motor, after its gear";
  output Types.Angle theta_c(start=init.theta_c, fixed=true, nominal=100) "Position of the secondary motor";
  output Types.AngularVelocity theta_c_dot(start=init.theta_c_dot, fixed=true, nominal=10)
    "Velocity of the secondary motor";
  output Types.Angle phi "Deformation of the transmission, q - theta";
  output Types.Length r "Length of the lever arm, (30)";
  output Types.Torque tau_e "Flexibility torque, (28)";

protected
  Types.Torque psi_e "Torque of the springs on the secondary motor, (31)";
equation
  // Transmission: springs at a lever arm that the secondary motor moves
  phi = q - theta;
  r = spring.r_0 - spring.b*theta_c; // (30)
  tau_e = spring.k_s*r^2*sin(2*phi); // (28)
  sigma = 2*spring.k_s*r^2*cos(2*phi); // (29)
  psi_e = -2*spring.k_s*spring.b*r*sin(phi)^2; // (31)

  // Link, (2)
  der(q) = q_dot;
  link.M*der(q_dot) + link.D_q*q_dot + link.tau_coulomb*tanh(q_dot/v_coulomb) + tau_e + link.mgl*sin(q) = tau_ext;

  // Principal motor, (3)
  der(theta) = theta_dot;
  motor.B*motor.gamma*der(theta_dot) + motor.D_theta*motor.gamma*theta_dot
    + motor.tau_coulomb*tanh(theta_dot/v_coulomb) - tau_e/motor.gamma = tau;

  // Secondary motor, third line of (5)
  der(theta_c) = theta_c_dot;
  motor_c.B*motor_c.gamma*der(theta_c_dot) + motor_c.D*motor_c.gamma*theta_c_dot + psi_e/motor_c.gamma = tau_c;

  // Measurements, (32), (33)
  q_measured = rounded(q, encoder.q);
  theta_measured = rounded(theta, encoder.theta);
  theta_c_measured = rounded(theta_c, encoder.theta_c);
  tau_measured = tau + noise.tau;
  tau_e_measured = sensor.gain*tau_e + noise.tau_e;

  annotation (Documentation(info="<html>
<p>The joint of section VI: a secondary motor moves the springs along a lever, by a ball screw, and so sets the stiffness. The torques
<code>tau_e</code> and <code>psi_e</code> are the derivatives of the potential k<sub>s</sub> r<sup>2</sup> sin<sup>2</sup> phi.</p>
<p>The secondary motor reaches its velocity within 10 us of a change of its torque: use a solver for stiff equations.</p>
</html>"));
end AwasPlant;
