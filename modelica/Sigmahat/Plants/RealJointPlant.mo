within Sigmahat.Plants;
model RealJointPlant
  "A robot joint with what real joints have: hysteresis, backlash, uneven friction, errors of gear, encoders and torque"
  extends Icons.Joint;
  import Sigmahat.Constants.v_coulomb;

  parameter Parameters.Link link "Link" annotation (Dialog(group="Joint"));
  parameter Parameters.Contact contact "Contact of the link" annotation (Dialog(group="Joint"));
  parameter Parameters.RealMotor motor "Motor" annotation (Dialog(group="Joint"));
  parameter Parameters.Gear gear "Gear" annotation (Dialog(group="Joint"));
  parameter Parameters.RealSpring spring "Transmission" annotation (Dialog(group="Joint"));
  parameter Parameters.RealEncoders encoder "Encoders" annotation (Dialog(group="Measurement"));
  parameter Parameters.RealSensor sensor "Torque sensors" annotation (Dialog(group="Measurement"));
  parameter Parameters.InitialJoint init "Initial state" annotation (Dialog(group="Start"));
  replaceable function drawNoise = standardNormal constrainedby partialNoise "What draws the noise";
  TorqueNoise noise(final side=1, redeclare function drawNoise = drawNoise) "Noise of the measured torques"
    annotation (Placement(transformation(extent={{-10,-90},{10,-70}})));

  Interfaces.RealInput tau(final unit="N.m") "Torque of the motor, on the motor axis"
    annotation (Placement(transformation(extent={{-140,60},{-100,100}})));
  Interfaces.RealInput r(final unit="m", start=0.07)
    "Length of the lever arm of the AwAS, (28); without effect if spring.k_s is 0"
    annotation (Placement(transformation(extent={{-140,20},{-100,60}})));
  Interfaces.RealInput D_theta_change(final unit="1")
    "Change of the viscous friction of the motor, relative to motor.D_theta"
    annotation (Placement(transformation(extent={{-140,-20},{-100,20}})));
  Interfaces.RealInput tau_coulomb_change(final unit="1")
    "Change of the Coulomb friction of the motor, relative to motor.tau_coulomb"
    annotation (Placement(transformation(extent={{-140,-60},{-100,-20}})));
  Interfaces.RealInput tau_ext(final unit="N.m") "External torque on the link"
    annotation (Placement(transformation(extent={{-140,-100},{-100,-60}})));

  Interfaces.RealOutput theta_measured(final unit="rad") "Position of the motor, from its encoder"
    annotation (Placement(transformation(extent={{100,70},{120,90}})));
  Interfaces.RealOutput q_measured(final unit="rad") "Position of the link, from its encoder"
    annotation (Placement(transformation(extent={{100,40},{120,60}})));
  Interfaces.RealOutput tau_measured(final unit="N.m") "Torque of the motor with noise, (32)"
    annotation (Placement(transformation(extent={{100,-10},{120,10}})));
  Interfaces.RealOutput tau_e_measured(final unit="N.m")
    "Flexibility torque as its sensor shows it, with gain and noise, (33)"
    annotation (Placement(transformation(extent={{100,-40},{120,-20}})));
  Interfaces.RealOutput sigma(final unit="N.m/rad")
    "Stiffness, its slope without damping and hysteresis; 0 in the dead zone"
    annotation (Placement(transformation(extent={{100,-90},{120,-70}})));

  output Types.Angle q(start=init.q, fixed=true) "Position of the link";
  output Types.AngularVelocity q_dot(start=init.q_dot, fixed=true) "Velocity of the link";
  output Types.Angle theta(start=init.theta, fixed=true) "Position of the motor, after its gear";
  output Types.AngularVelocity theta_dot(start=init.theta_dot, fixed=true) "Velocity of the motor, after its gear";
  output Types.Angle phi "Deformation of the transmission, q - theta";
  output Types.Torque tau_e
    "Flexibility torque, k_1 x + k_3 x^3 + k_s r^2 sin 2x, plus damping and hysteresis; x is the deformation of the spring behind gear and dead zone";

protected
  Types.AngularVelocity phi_dot "Velocity of the deformation";
  Types.Angle deformation "Deformation behind the gear";
  Types.Angle x "Deformation of the spring, behind its dead zone";
  Types.Torque tau_dahl(start=0, fixed=true) "Torque of the hysteresis";
  Types.Ratio direction "Sign of the velocity of the motor, smooth";
  Types.Torque tau_viscous "Viscous friction of the motor";
  Types.Torque tau_coulomb "Coulomb friction of the motor";
  Types.Torque tau_load "Friction of the load";
  Types.Torque tau_cogging "Cogging torque";
  constant Types.Angle zero_q = 0.4, zero_theta = 0.7 "Where the eccentric encoders have their zero";
equation
  // The gear has a kinematic error, once or several times per turn of the motor
  phi = q - theta;
  phi_dot = q_dot - theta_dot;
  deformation = phi + gear.kinematic_error*sin(gear.kinematic_order*motor.gamma*theta);

  // Spring behind the dead zone, (4), (28), (29)
  x = noEvent(max(deformation - spring.gap, 0) + min(deformation + spring.gap, 0));
  sigma = noEvent(if abs(deformation) > spring.gap or spring.gap <= 0 then
    spring.k_1 + 3*spring.k_3*x^2 + 2*spring.k_s*r^2*cos(2*x) else 0);
  tau_e = spring.k_1*x + spring.k_3*x^3 + spring.k_s*r^2*sin(2*x) + spring.damping*sigma*phi_dot + tau_dahl;

  // Hysteresis: P. Dahl, "A solid friction model", 1968, of the exponent 1
  spring.dahl_phi*der(tau_dahl) = spring.dahl*phi_dot - noEvent(abs(phi_dot))*tau_dahl;

  // Link, (2), with its contact
  der(q) = q_dot;
  link.M*der(q_dot) + link.D_q*q_dot + link.tau_coulomb*tanh(q_dot/v_coulomb) + tau_e + link.mgl*sin(q)
    + contact.k*q + contact.d*q_dot = tau_ext;

  // Motor, (3), with friction that bends, sticks, is uneven and grows with the load
  der(theta) = theta_dot;
  direction = tanh(theta_dot/v_coulomb);
  tau_viscous = motor.D_theta*(1 + D_theta_change)*motor.gamma*theta_dot
    /sqrt(1 + (if motor.v_bend > 0 then theta_dot/motor.v_bend else 0)^2);
  tau_coulomb = motor.tau_coulomb*(1 + tau_coulomb_change)
    *((1 + motor.stribeck*exp(-(theta_dot/motor.v_stribeck)^2))*direction + motor.uneven);
  tau_load = motor.load_friction*noEvent(abs(tau_e))/motor.gamma*direction;
  tau_cogging = motor.cogging*sin(motor.cogging_order*motor.gamma*theta);
  motor.B*motor.gamma*der(theta_dot) + tau_viscous + tau_coulomb + tau_load - tau_cogging - tau_e/motor.gamma = tau;

  // Measurements, (32), (33), with errors
  q_measured = rounded(
    q + encoder.q_eccentricity*sin(q + zero_q) + encoder.q_offset + encoder.q_delay*q_dot, encoder.q);
  theta_measured = rounded(
    theta + encoder.theta_eccentricity*sin(motor.gamma*theta + zero_theta), encoder.theta);
  tau_measured = (tau - sensor.tau_bias)/sensor.tau_gain + noise.tau;
  tau_e_measured = sensor.gain*tau_e + noise.tau_e;

  annotation (Documentation(info="<html>
<p>The joint of <a href=\"modelica://Sigmahat.Plants.FlexibleJointPlant\">FlexibleJointPlant</a> with departures from the models of the
estimators. Each is a parameter, which starts at the value for &quot;none&quot;. The spring is linear and cubic, or that of the AwAS (28) with
its lever arm as an input, or a sum of both.</p>
</html>"));
end RealJointPlant;
