within Sigmahat.Plants;
package Parameters "Groups of parameters of the plants"
  extends Icons.Package;

  record Link "Link, (2)"
    extends Icons.Record;
    parameter Types.Inertia M(min=1e-15) = 0.1 "Inertia of the link, (2)";
    parameter Types.Friction D_q(min=0) = 0.15 "Viscous friction of the link, (2)";
    parameter Types.Torque tau_coulomb(min=0) = 0
      "Coulomb friction of the link: tau_coulomb tanh(q_dot / (0.02 rad/s))";
    parameter Types.Torque mgl = 0
      "Gravity torque of the horizontal link; the link hangs at q = 0: g(q) = mgl sin q, (2)";
    annotation (Documentation(info="<html><p>Data of the link, with the values of the AwAS.</p></html>"));
  end Link;

  record Motor "Motor, (3)"
    extends Icons.Record;
    parameter Types.Inertia B(min=1e-15) = 2.3e-5 "Inertia of the rotor, (3)";
    parameter Types.Friction D_theta(min=0) = 1e-3 "Viscous friction, (3)";
    parameter Types.Ratio gamma(min=1e-15) = 50 "Gear ratio, (3)";
    parameter Types.Torque tau_coulomb(min=0) = 0
      "Coulomb friction, on the motor axis: tau_coulomb tanh(theta_dot / (0.02 rad/s))";
    annotation (Documentation(info="<html><p>Data of a motor, with the values of the AwAS.</p></html>"));
  end Motor;

  record SecondaryMotor "Secondary motor, (5)"
    extends Icons.Record;
    parameter Types.Inertia B(min=1e-15) = 1.29e-7 "Inertia of the rotor, (5)";
    parameter Types.Friction D(min=0) = 0.0141 "Viscous friction, (5)";
    parameter Types.Ratio gamma(min=1e-15) = 23 "Gear ratio, (5)";
    annotation (Documentation(info="<html><p>Data of the motor that sets the stiffness of the AwAS.</p></html>"));
  end SecondaryMotor;

  record Sensor "Sensor of the flexibility torque"
    extends Icons.Record;
    parameter Types.Ratio gain = 1 "Gain of the sensor of the flexibility torque; 1: no scale error";
    annotation (Documentation(info="<html><p>Its noise is in <code>noise</code>.</p></html>"));
  end Sensor;

  record Encoders "Encoders of a joint with one motor"
    extends Icons.Record;
    parameter Types.Ratio q(min=0) = 40000 "Counts per turn of the encoder of q; 0: not quantised";
    parameter Types.Ratio theta(min=0) = 40000 "Counts per turn of the encoder of theta; 0: not quantised";
    annotation (Documentation(info="<html><p>Resolutions.</p></html>"));
  end Encoders;

  record AwasEncoders "Encoders of the AwAS"
    extends Encoders;
    parameter Types.Ratio theta_c(min=0) = 1024 "Counts per turn of the encoder of theta_c; 0: not quantised";
    annotation (Documentation(info="<html><p>Resolutions.</p></html>"));
  end AwasEncoders;

  record AntagonisticEncoders "Encoders of a joint with two motors"
    extends Icons.Record;
    parameter Types.Ratio q(min=0) = 40000 "Counts per turn of the encoder of q; 0: not quantised";
    parameter Types.Ratio theta_1(min=0) = 40000 "Counts per turn of the encoder of theta_1; 0: not quantised";
    parameter Types.Ratio theta_2(min=0) = 40000 "Counts per turn of the encoder of theta_2; 0: not quantised";
    annotation (Documentation(info="<html><p>Resolutions.</p></html>"));
  end AntagonisticEncoders;

  record InitialLink "Initial state of the link"
    extends Icons.Record;
    parameter Types.Angle q = 0 "Position of the link at the start";
    parameter Types.AngularVelocity q_dot = 0 "Velocity of the link at the start";
    annotation (Documentation(info="<html><p>Initial values.</p></html>"));
  end InitialLink;

  record InitialJoint "Initial state of a joint with one motor"
    extends InitialLink;
    parameter Types.Angle theta = 0 "Position of the motor at the start";
    parameter Types.AngularVelocity theta_dot = 0 "Velocity of the motor at the start";
    annotation (Documentation(info="<html><p>Initial values.</p></html>"));
  end InitialJoint;

  record InitialAwas "Initial state of the AwAS"
    extends InitialJoint;
    parameter Types.Angle theta_c = 0.030/(0.0025/(2*Constants.pi))
      "Position of the secondary motor at the start; 0.030/b is a lever arm of 70 mm";
    parameter Types.AngularVelocity theta_c_dot = 0 "Velocity of the secondary motor at the start";
    annotation (Documentation(info="<html><p>Initial values.</p></html>"));
  end InitialAwas;

  record InitialAntagonistic "Initial state of a joint with two motors"
    extends InitialLink;
    parameter Types.Angle theta_1 = 0 "Position of the motor 1 at the start";
    parameter Types.AngularVelocity theta_dot_1 = 0 "Velocity of the motor 1 at the start";
    parameter Types.Angle theta_2 = 0 "Position of the motor 2 at the start";
    parameter Types.AngularVelocity theta_dot_2 = 0 "Velocity of the motor 2 at the start";
    annotation (Documentation(info="<html><p>Initial values.</p></html>"));
  end InitialAntagonistic;

  record LeverSpring "Springs of the AwAS at their lever arm, (28)-(30)"
    extends Icons.Record;
    parameter Types.SpringStiffness k_s(min=0) = 14220 "Stiffness of the springs, (28)";
    parameter Types.Length r_0 = 0.1 "Length of the lever arm at theta_c = 0, (30)";
    parameter Types.Lead b = 0.0025/(2*Constants.pi) "Lead of the ball screw, (30)";
    annotation (Documentation(info="<html><p>The ball screw has a lead of 2.5 mm per turn.</p></html>"));
  end LeverSpring;

  record HardeningSpring "Spring that is linear or hardens"
    extends Icons.Record;
    parameter Types.Stiffness k_1(min=0) = 150 "Stiffness of the undeformed transmission";
    parameter Types.CubicStiffness k_3 = 0
      "Above 0 the transmission hardens with deformation, below it softens; 0: it is linear";
    annotation (Documentation(info="<html><p>tau_e = k_1 phi + k_3 phi<sup>3</sup></p></html>"));
  end HardeningSpring;

  record ExponentialSpring "Spring of one side of an antagonistic joint"
    extends Icons.Record;
    parameter Types.Torque k(min=0) "Torque scale of the transmission: tau_e = k sinh(a phi)";
    parameter Types.PerAngle a(min=1e-15) "How fast the transmission hardens: tau_e = k sinh(a phi)";
    annotation (Documentation(info="<html><p>tau_e = k sinh(a phi)</p></html>"));
  end ExponentialSpring;

  record Contact "Contact of the link with its surroundings"
    extends Icons.Record;
    parameter Types.Stiffness k(min=0) = 0
      "Stiffness of a contact of the link with its surroundings, without torque at q = 0; 0: no contact";
    parameter Types.Friction d(min=0) = 0 "Damping of the contact";
    annotation (Documentation(info="<html><p>A spring and a damper to the surroundings.</p></html>"));
  end Contact;

  record RealMotor "Motor whose friction is that of real ones"
    extends Motor;
    parameter Types.AngularVelocity v_bend(min=0) = 0
      "Viscous friction is D_theta gamma v / sqrt(1 + (v / v_bend)^2), v the velocity after the gear; 0: it is linear";
    parameter Types.Ratio uneven = 0
      "Coulomb friction is tau_coulomb (sign + uneven): how much it differs between the directions; 0: not at all";
    parameter Types.Ratio load_friction(min=0) = 0
      "Friction per flexibility torque on the motor axis, of the sign of the velocity; 0: friction does not depend on the load";
    parameter Types.Ratio stribeck(min=0) = 0
      "By how much Coulomb friction is larger at rest, relative; 0: it is constant";
    parameter Types.AngularVelocity v_stribeck(min=1e-15) = 0.1
      "That is exp(-(v / v_stribeck)^2) at a velocity v after the gear";
    parameter Types.Torque cogging = 0
      "Amplitude of the cogging torque of the motor, on its axis; 0: no cogging";
    parameter Types.Ratio cogging_order(min=0) = 6 "Periods of the cogging torque per turn of the motor";
    annotation (Documentation(info="<html><p>Each parameter starts at the value for &quot;none&quot;.</p></html>"));
  end RealMotor;

  record Gear "Gear with an error"
    extends Icons.Record;
    parameter Types.Angle kinematic_error = 0
      "Amplitude of the kinematic error of the gear, behind it; 0: no error";
    parameter Types.Ratio kinematic_order(min=0) = 2 "Periods of the kinematic error per turn of the motor";
    annotation (Documentation(info="<html><p>The error is added to the deformation.</p></html>"));
  end Gear;

  record RealSpring "Spring with backlash, damping and hysteresis"
    extends Icons.Record;
    parameter Types.Stiffness k_1(min=0) = 150 "Stiffness of the undeformed spring";
    parameter Types.CubicStiffness k_3 = 0
      "Above 0 the spring hardens with deformation, below it softens; 0: it is linear";
    parameter Types.SpringStiffness k_s(min=0) = 0
      "Stiffness of the springs of the AwAS on the lever arm r, (28); 0: a joint without lever";
    parameter Types.Angle gap(min=0) = 0 "Half the width of the dead zone of the spring (backlash); 0: none";
    parameter Types.Time damping(min=0) = 0
      "Damping of the spring per stiffness: the torque damping sigma (q_dot - theta_dot) is added; 0: none";
    parameter Types.Torque dahl(min=0) = 0
      "Hysteresis after Dahl: torque that it reaches in a long motion; 0: none";
    parameter Types.Angle dahl_phi(min=1e-15) = 1e-3
      "Deformation in which the hysteresis goes 63 % of the way";
    annotation (Documentation(info="<html><p>Each parameter but <code>k_1</code> starts at the value for &quot;none&quot;.</p></html>"));
  end RealSpring;

  record RealEncoders "Encoders with errors"
    extends Encoders;
    parameter Types.Angle q_eccentricity = 0
      "Amplitude of the error of the encoder of q, once per turn; 0: centred";
    parameter Types.Angle q_offset = 0 "Error of the zero of q, and so of the deformation";
    parameter Types.Time q_delay = 0 "How much later than theta q is read";
    parameter Types.Angle theta_eccentricity = 0
      "Amplitude of the error of the encoder of theta, behind the gear, once per turn of the motor; 0: centred";
    annotation (Documentation(info="<html><p>Each error starts at 0.</p></html>"));
  end RealEncoders;

  record RealSensor "Torque sensors with errors"
    extends Sensor;
    parameter Types.Ratio tau_gain(min=1e-15) = 1
      "The measured motor torque is (tau - tau_bias) / tau_gain; 1: no scale error";
    parameter Types.Torque tau_bias = 0 "Motor torque that is not measured, on the motor axis";
    annotation (Documentation(info="<html><p>Each error starts at the value for &quot;none&quot;.</p></html>"));
  end RealSensor;

  annotation (Documentation(info="<html>
<p>Records, so that the parameters have the names of the FMUs: <code>motor.gamma</code>.</p>
</html>"));
end Parameters;
