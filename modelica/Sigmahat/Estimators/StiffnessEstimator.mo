within Sigmahat.Estimators;
block StiffnessEstimator
  "On-line stiffness estimator for a flexible robot joint, from encoders and motor torque"
  extends Icons.Estimator;
  extends Settings;

  parameter Parameters.Motor motor "Motor" annotation (Dialog(group="Joint"));

  Interfaces.RealInput theta(final unit="rad") "Measured position of the principal motor, after its gear"
    annotation (Placement(transformation(extent={{-140,60},{-100,100}})));
  Interfaces.RealInput q(final unit="rad") "Measured position of the link"
    annotation (Placement(transformation(extent={{-140,20},{-100,60}})));
  Interfaces.RealInput theta_c(final unit="rad") "Measured position of the secondary motor"
    annotation (Placement(transformation(extent={{-140,-20},{-100,20}})));
  Interfaces.RealInput tau(final unit="N.m") "Torque of the principal motor, on the motor axis"
    annotation (Placement(transformation(extent={{-140,-60},{-100,-20}})));
  Interfaces.RealInput tau_e_sensor(final unit="N.m")
    "Measured flexibility torque, for modality Sensor; checked in every modality"
    annotation (Placement(transformation(extent={{-140,-100},{-100,-60}})));

  Interfaces.RealOutput sigma(final unit="N.m/rad", start=0)
    "Stiffness estimate, (23); with method FilteredRegression the slope of the torque where the spring is engaged, without hysteresis"
    annotation (Placement(transformation(extent={{100,70},{120,90}})));
  Interfaces.RealOutput sigma_std(final unit="N.m/rad", min=0)
    "Standard deviation of sigma; with method Paper2011 it contains the white noise of the torque and no other error, and is no claim"
    annotation (Placement(transformation(extent={{100,40},{120,60}})));
  Interfaces.RealOutput tau_e(final unit="N.m", start=0) "Flexibility torque of the fitted model, (21)"
    annotation (Placement(transformation(extent={{100,10},{120,30}})));
  Interfaces.RealOutput tau_e_residual(final unit="N.m", start=0)
    "Flexibility torque from the motor data: gamma r_e of (8); with method FilteredRegression gamma (B gamma theta'' + D_theta gamma theta' - tau) through its filter, or the measured torque through its filter"
    annotation (Placement(transformation(extent={{100,-20},{120,0}})));
  Interfaces.BooleanOutput confident
    "True if doubt is None: sigma_std is below limit.relative_std |sigma|, and nothing contradicts it; while valid is false it is that of the last good tick"
    annotation (Placement(transformation(extent={{100,-60},{120,-40}})));
  Interfaces.BooleanOutput valid
    "False while the last tick was skipped: an input, used or not, was not finite or above 1e12 in magnitude"
    annotation (Placement(transformation(extent={{100,-90},{120,-70}})));

  discrete output Types.Torque tau_e_std(min=0) "Standard deviation of tau_e, as sigma_std of sigma";
  discrete output Types.AngularVelocity theta_dot(start=0)
    "Velocity of the principal motor, as the residual uses it; with method FilteredRegression through its filter, which delays it";
  discrete output Types.Angle phi
    "Deformation q - theta, as the regression uses it; with method FilteredRegression as measured";
  discrete output Types.Ratio setPoint_used "Set-point setPoint.offset + setPoint.scale theta_c, as the regression uses it";
  discrete output Types.Ratio a(min=0)
    "Stability factor a(k), (27); with method FilteredRegression 1 if the regression used the sample, else 0";
  discrete output Types.Ratio rho(min=0)
    "Variance of the prediction F' P F before the update, (14); with method FilteredRegression divided by the variance of the sample";
  discrete output Types.Torque epsilon "Prediction error of the flexibility torque before the update, (14)";
  discrete output Real eta[8, 5]
    "eta[i+1,j+1]: coefficient of setPoint^j phi^(2i+1), (21), in N.m over that unit; of setPoint^j phi^i if rls.symmetric is false";
  discrete output Types.Friction D_theta_hat "Viscous friction of the motor, corrected by method FilteredRegression";
  discrete output Types.Inertia B_hat "Inertia of the rotor, corrected by method FilteredRegression";
  discrete output Types.Torque tau_coulomb_hat
    "Coulomb friction of the motor, on its axis, estimated by method FilteredRegression; may be slightly below 0 if there is none";
  discrete output Types.Ratio misfit(min=1)
    "FilteredRegression: square root of how much larger the slow part of the prediction error is than its noise; 1 where the model holds";
  discrete output Types.Torque bias_hat
    "FilteredRegression: constant torque: bias of the torque, zero of the deformation, uneven friction; behind the gear";
  discrete output Types.Friction damping_hat
    "FilteredRegression: damping of the spring at this set-point; contains encoders that are read at different times";
  discrete output Types.Ratio load_friction_hat "FilteredRegression: friction per torque, of spring and motor";
  discrete output Types.Angle eccentric_hat
    "FilteredRegression: amplitude of the once-per-turn error of the link encoder";
  discrete output Types.Time delay_hat "FilteredRegression: delay of the torque against the positions";
  discrete output Types.Torque hysteresis_hat
    "FilteredRegression: half the height of the hysteresis loop; 0 while the data show none";
  discrete output Types.Ratio sigma_per_gain
    "Relative change of sigma with a relative change of the gain of the torque, which no data show";
  discrete output Types.Doubt doubt "Why the estimate is not confident";

protected
  Internal.Estimator estimator = Internal.Estimator(
    samplePeriod, method, modality, deformation, filter.kind, filter.weighting, rls.kind, rls.symmetric, rls.n, rls.m,
    torque.held, limit.relative_std,
    {motor.B, motor.D_theta, motor.gamma},
    residual.K_I,
    {filter.V_a, filter.V_max, filter.V_min, filter.alpha, filter.R, filter.P_0},
    {encoder.theta, encoder.q},
    {setPoint.offset, setPoint.scale},
    {rls.P_0, rls.c, rls.a},
    rls.eta_0,
    {nominal.k_s, nominal.r_0, nominal.b},
    {noise.tau, noise.tau_e},
    {regression.bandwidth, regression.slow, regression.drift, regression.memory},
    {range.phi, range.setPoint},
    {prior.tau_e, prior.nominal, prior.D_theta, prior.B, prior.tau_coulomb, prior.torque_gain, prior.bias, prior.damping,
     prior.load_friction, prior.eccentric, prior.delay, prior.reversal, prior.power, prior.gap, prior.hysteresis,
     prior.eccentric_motor});
algorithm
  when sample(startTime, samplePeriod) then
    (sigma, tau_e, tau_e_residual, theta_dot, phi, setPoint_used, a, rho, epsilon, eta, sigma_std, tau_e_std, D_theta_hat, B_hat,
     tau_coulomb_hat, misfit, bias_hat, damping_hat, load_friction_hat, eccentric_hat, delay_hat, hysteresis_hat,
     sigma_per_gain, doubt, confident, valid) := Internal.tick(
      estimator, time, theta, q, theta_c, tau, tau_e_sensor);
  end when;

  annotation (Documentation(info="<html>
<p>One tick of the paper's Fig. 1, or of method FilteredRegression, every <code>samplePeriod</code>. For actuators with adjustable stiffness and, with
<code>rls.m</code> = 1, for a single flexible transmission.</p>
<p>Parameters to set first: <code>motor</code>, <code>encoder</code> and <code>samplePeriod</code>; for a joint without a second motor
<code>setPoint.scale</code> = 0 and <code>rls.m</code> = 1; for method FilteredRegression also <code>range</code> and <code>prior</code>.</p>
<p>The output <code>setPoint</code> of the FMU is called <code>setPoint_used</code>, because the parameters have the name
<code>setPoint</code>. The FMU has the estimate of a tick at the end of the step that begins with it; this block has it at the tick.</p>
<p>Parameters that are tunable in the FMU are constant here during a run, as all parameters of Modelica.</p>
</html>"));
end StiffnessEstimator;
