within Sigmahat.Estimators;
block AntagonisticStiffnessEstimator
  "On-line stiffness estimator for a joint with two antagonistic flexible transmissions, from encoders and motor torques"
  extends Icons.Estimator;
  extends Settings(setPoint(final scale=0), nominal(final b=0));

  parameter Parameters.Motor motor_1 "Motor 1" annotation (Dialog(group="Joint"));
  parameter Parameters.Motor motor_2 "Motor 2" annotation (Dialog(group="Joint"));

  Interfaces.RealInput theta_1(final unit="rad") "Measured position of motor 1, after its gear"
    annotation (Placement(transformation(extent={{-120,80},{-100,100}})));
  Interfaces.RealInput theta_2(final unit="rad") "Measured position of motor 2, after its gear"
    annotation (Placement(transformation(extent={{-120,50},{-100,70}})));
  Interfaces.RealInput q(final unit="rad") "Measured position of the link"
    annotation (Placement(transformation(extent={{-120,20},{-100,40}})));
  Interfaces.RealInput tau_1(final unit="N.m") "Torque of motor 1, on the motor axis"
    annotation (Placement(transformation(extent={{-120,-10},{-100,10}})));
  Interfaces.RealInput tau_2(final unit="N.m") "Torque of motor 2, on the motor axis"
    annotation (Placement(transformation(extent={{-120,-40},{-100,-20}})));
  Interfaces.RealInput tau_e_sensor_1(final unit="N.m")
    "Measured flexibility torque of transmission 1, for modality Sensor; checked in every modality"
    annotation (Placement(transformation(extent={{-120,-70},{-100,-50}})));
  Interfaces.RealInput tau_e_sensor_2(final unit="N.m")
    "Measured flexibility torque of transmission 2, for modality Sensor; checked in every modality"
    annotation (Placement(transformation(extent={{-120,-100},{-100,-80}})));

  Interfaces.RealOutput sigma(final unit="N.m/rad") "Stiffness estimate of the device, sigma_1 + sigma_2"
    annotation (Placement(transformation(extent={{100,70},{120,90}})));
  Interfaces.RealOutput sigma_std(final unit="N.m/rad")
    "Standard deviation of sigma: root of the sum of the squares of sigma_std_1 and sigma_std_2, as if their errors were independent"
    annotation (Placement(transformation(extent={{100,40},{120,60}})));
  Interfaces.RealOutput sigma_1(final unit="N.m/rad") "Stiffness estimate of transmission 1"
    annotation (Placement(transformation(extent={{100,10},{120,30}})));
  Interfaces.RealOutput sigma_2(final unit="N.m/rad") "Stiffness estimate of transmission 2"
    annotation (Placement(transformation(extent={{100,-20},{120,0}})));
  Interfaces.BooleanOutput confident "True if doubt is None"
    annotation (Placement(transformation(extent={{100,-60},{120,-40}})));
  Interfaces.BooleanOutput valid "True if both sides are valid"
    annotation (Placement(transformation(extent={{100,-90},{120,-70}})));
  output Types.Doubt doubt
    "Why the estimate of the device is not confident: what contradicts the estimate of a side, or that sigma_std is not below limit.relative_std |sigma|";

  StiffnessEstimator side_1(
    final samplePeriod=samplePeriod, final startTime=startTime, final method=method, final modality=modality,
    final limit=limit, final encoder=encoder, final setPoint=setPoint, final nominal=nominal,
    final noise=noise, final rls=rls, final deformation=deformation, final residual=residual, final filter=filter,
    final torque=torque, final regression=regression, final range=range, final prior=prior, final motor=motor_1)
    "Estimator of transmission 1" annotation (Placement(transformation(extent={{-20,20},{20,60}})));
  StiffnessEstimator side_2(
    final samplePeriod=samplePeriod, final startTime=startTime, final method=method, final modality=modality,
    final limit=limit, final encoder=encoder, final setPoint=setPoint, final nominal=nominal,
    final noise=noise, final rls=rls, final deformation=deformation, final residual=residual, final filter=filter,
    final torque=torque, final regression=regression, final range=range, final prior=prior, final motor=motor_2)
    "Estimator of transmission 2" annotation (Placement(transformation(extent={{-20,-60},{20,-20}})));

protected
  Types.Doubt worse "The doubt of the two sides that stands last";
equation
  side_1.theta_c = 0;
  side_2.theta_c = 0;
  connect(theta_1, side_1.theta) annotation (Line(points={{-110,90},{-40,90},{-40,56},{-24,56}}, color={0,0,127}));
  connect(q, side_1.q) annotation (Line(points={{-110,30},{-60,30},{-60,48},{-24,48}}, color={0,0,127}));
  connect(tau_1, side_1.tau) annotation (Line(points={{-110,0},{-50,0},{-50,32},{-24,32}}, color={0,0,127}));
  connect(tau_e_sensor_1, side_1.tau_e_sensor)
    annotation (Line(points={{-110,-60},{-44,-60},{-44,24},{-24,24}}, color={0,0,127}));
  connect(theta_2, side_2.theta) annotation (Line(points={{-110,60},{-70,60},{-70,-24},{-24,-24}}, color={0,0,127}));
  connect(q, side_2.q) annotation (Line(points={{-110,30},{-60,30},{-60,-32},{-24,-32}}, color={0,0,127}));
  connect(tau_2, side_2.tau) annotation (Line(points={{-110,-30},{-80,-30},{-80,-48},{-24,-48}}, color={0,0,127}));
  connect(tau_e_sensor_2, side_2.tau_e_sensor)
    annotation (Line(points={{-110,-90},{-40,-90},{-40,-56},{-24,-56}}, color={0,0,127}));

  sigma_1 = side_1.sigma;
  sigma_2 = side_2.sigma;
  sigma = sigma_1 + sigma_2;
  sigma_std = sqrt(side_1.sigma_std^2 + side_2.sigma_std^2);
  valid = side_1.valid and side_2.valid;

  // That one side alone is not certain enough is no reason.
  worse = if side_1.doubt > side_2.doubt then side_1.doubt else side_2.doubt;
  doubt = if worse <> Types.Doubt.None and worse <> Types.Doubt.NotExcited and worse <> Types.Doubt.Misfit then worse
    elseif sigma_std < limit.relative_std*abs(sigma) then Types.Doubt.None
    elseif worse <> Types.Doubt.None then worse else Types.Doubt.NotExcited;
  confident = doubt == Types.Doubt.None;

  annotation (Documentation(info="<html>
<p>Two <a href=\"modelica://Sigmahat.Estimators.StiffnessEstimator\">estimators</a>, one for each motor, with the parameters of this block and the
motor of their side; they share the encoder of the link. What the FMU calls <code>tau_e_1</code> is <code>side_1.tau_e</code>, and so for all
outputs of a side. Set <code>rls.m</code> = 1: there is no set-point.</p>
</html>"));
end AntagonisticStiffnessEstimator;
