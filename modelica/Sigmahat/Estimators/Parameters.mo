within Sigmahat.Estimators;
package Parameters "Groups of parameters of the estimators"
  extends Icons.Package;

  record Motor "Data of the motor, (3)"
    extends Icons.Record;
    parameter Types.Inertia B(min=1e-15) = 2.3e-5 "Inertia of the rotor, (3)";
    parameter Types.Friction D_theta(min=0) = 1e-3 "Viscous friction of the motor, (3)";
    parameter Types.Ratio gamma = 50 "Gear ratio, not 0";
    annotation (Documentation(info="<html><p>With the values of the AwAS.</p></html>"));
  end Motor;

  record Residual "Residual, (6)"
    extends Icons.Record;
    parameter Types.Rate K_I(min=1e-15) = 300 "Paper2011: bandwidth of the residual, (6); K_I T must be below 2";
    annotation (Documentation(info="<html><p>Of method Paper2011.</p></html>"));
  end Residual;

  record Filter "Kalman filter of the motor position, (9)-(11)"
    extends Icons.Record;
    parameter Types.FilterKind kind = Types.FilterKind.ModifiedKalman "Paper2011: how the motor velocity is obtained";
    parameter Types.Weighting weighting = Types.Weighting.Normalized "How (11) compares velocity and encoder resolution";
    parameter Types.AccelerationVariance V_a(min=0) = 3e9 "Variance of the acceleration, (9)";
    parameter Types.AngleVariance V_max(min=1e-30) = 10 "Measurement variance at rest, (11)";
    parameter Types.AngleVariance V_min(min=1e-30) = 0.1 "Measurement variance in fast motion, (11); not above filter.V_max";
    parameter Types.Ratio alpha(min=0) = 6 "Steepness between the two variances, (11)";
    parameter Types.AngleVariance R(min=1e-30) = 10 "Measurement variance of filter.kind Kalman, (10)";
    parameter Real P_0(min=1e-30) = 1 "Initial covariance of the filter, both diagonal entries";
    annotation (Documentation(info="<html><p>Of method Paper2011.</p></html>"));
  end Filter;

  record Encoder "Resolution of the encoders"
    extends Icons.Record;
    parameter Types.Ratio theta(min=0) = 40000
      "Counts per turn of theta, 0: not quantised; Paper2011 compares the velocity with it, (11), and FilteredRegression computes the rounding error from it; for a sensor with noise of standard deviation s rad, set 2 pi / (sqrt(12) s)";
    parameter Types.Ratio q(min=0) = 40000 "Counts per turn of q, 0: not quantised; Paper2011 uses it with deformation = Filtered only";
    annotation (Documentation(info="<html><p>Counts per turn, behind the gear.</p></html>"));
  end Encoder;

  record SetPoint "Set-point of the stiffness"
    extends Icons.Record;
    parameter Types.Ratio offset = 100 "Set-point at theta_c = 0; for the AwAS the lever arm in mm";
    parameter Types.PerAngle scale = -0.0025/(2*Constants.pi)*1000 "Set-point per theta_c; for the AwAS in mm/rad";
    annotation (Documentation(info="<html><p>set-point = offset + scale theta_c</p></html>"));
  end SetPoint;

  record Rls "Regression, (14)-(27)"
    extends Icons.Record;
    parameter Types.RlsKind kind = Types.RlsKind.Enhanced "Paper2011: recursive least squares";
    parameter Boolean symmetric = true "True: the torque is odd in the deformation, (16), powers 2i+1; false: any, powers i from 0 on";
    parameter Integer n(min=1, max=8) = 6 "Order of the polynomial in the deformation, (18)";
    parameter Integer m(min=1, max=5) = 3 "Order of the polynomial in the set-point, (19); 1 for a transmission without set-point";
    parameter Real P_0(min=1e-30) = 1e20 "Paper2011: initial covariance, every diagonal entry of P(0), (14)";
    parameter Types.Ratio c(min=1e-30) = 1e-20 "Constant c of (27), for rls.kind Enhanced";
    parameter Types.Ratio a(min=1e-15, max=1) = 0.1 "Stability factor of rls.kind ConstantFactor, (25)";
    parameter Real eta_0[8, 5] = zeros(8, 5)
      "Initial estimate of eta; FilteredRegression: its prior mean, the nominal curve";
    annotation (Documentation(info="<html><p>Of both methods, where a parameter does not name one.</p></html>"));
  end Rls;

  record Nominal "Nominal torque (28) of modality Model"
    extends Icons.Record;
    parameter Types.SpringStiffness k_s(min=0) = 14220 "Stiffness of the springs, (28), for modality Model";
    parameter Types.Length r_0 = 0.1 "Lever arm at theta_c = 0, (30), for modality Model";
    parameter Types.Lead b = 0.0025/(2*Constants.pi) "Lever arm per theta_c, (30), for modality Model";
    annotation (Documentation(info="<html><p>The FMU calls this group <code>model</code>, which is a keyword of Modelica.</p></html>"));
  end Nominal;

  record Limit "When the estimate is confident"
    extends Icons.Record;
    parameter Types.Ratio relative_std(min=1e-15) = 0.1 "Ratio sigma_std / |sigma| below which the estimate is confident";
    annotation (Documentation(info="<html><p>Limits of the uncertainty.</p></html>"));
  end Limit;

  record Noise "Noise of the torques"
    extends Icons.Record;
    parameter Types.Torque tau(min=1e-12, max=1e12) = 3.2e-3
      "Standard deviation of the noise of tau, on the motor axis; Paper2011 uses it for sigma_std only";
    parameter Types.Torque tau_e(min=1e-12, max=1e12) = 3.2e-2
      "Standard deviation of the noise of tau_e_sensor, or of the error of the nominal torque of modality Model; Paper2011 uses it for sigma_std only";
    annotation (Documentation(info="<html><p>Standard deviations.</p></html>"));
  end Noise;

  record Torque "How the torque is held"
    extends Icons.Record;
    parameter Boolean held = false
      "FilteredRegression: true if a drive holds each value of tau until the next sample; false: tau is linear between samples";
    annotation (Documentation(info="<html><p>Of method FilteredRegression.</p></html>"));
  end Torque;

  record Regression "Method FilteredRegression"
    extends Icons.Record;
    parameter Types.AngularVelocity bandwidth(min=1e-15) = 350
      "FilteredRegression: corner w of the filter (w/(s + w))^3 that all signals pass; w T from 1e-4 to below 2; a smaller one is used if the rounding of theta needs it";
    parameter Types.AngularVelocity slow(min=1e-15) = 0.05
      "FilteredRegression: motor velocity below which the sign of Coulomb friction is unknown";
    parameter Types.Rate drift(min=0, max=1e12) = 0
      "FilteredRegression: share of its prior variance by which the torque curve drifts in a second; 0: it does not change";
    parameter Types.Time memory(min=0, max=1e12) = 20
      "FilteredRegression: time constant with which data are forgotten while they contradict the model; 0: the misfit has no effect";
    annotation (Documentation(info="<html><p>Its filter and its memory.</p></html>"));
  end Regression;

  record Range "Ranges of the operating point"
    extends Icons.Record;
    parameter Types.Angle phi(min=1e-6, max=1e6) = 0.3
      "FilteredRegression: largest expected deformation; far beyond it (from 2 to 32 times, by rls.n), a warning is logged once";
    parameter Types.Ratio setPoint(min=1e-12, max=1e12) = 100 "FilteredRegression: largest expected set-point";
    annotation (Documentation(info="<html><p>Deformation and set-point are scaled by them.</p></html>"));
  end Range;

  record Prior "What is not known exactly"
    extends Icons.Record;
    parameter Types.Torque tau_e(min=0, max=1e12) = 45
      "FilteredRegression: prior standard deviation of each coefficient of the flexibility torque, for deformation and set-point in units of their ranges; 0: the shape of the curve rls.eta_0 is exact, and prior.nominal must be above 0";
    parameter Types.Ratio nominal(min=0, max=1e12) = 0 "FilteredRegression: relative prior standard deviation of the curve rls.eta_0 as a whole";
    parameter Types.Ratio D_theta(min=0, max=1e12) = 0.2
      "FilteredRegression: relative prior standard deviation of the viscous friction D_theta; 0: it is exact, and so is a D_theta of 0";
    parameter Types.Ratio B(min=0, max=1e12) = 0 "FilteredRegression: relative prior standard deviation of the rotor inertia B; 0: it is exact";
    parameter Types.Torque tau_coulomb(min=0, max=1e12) = 0.02
      "FilteredRegression: prior standard deviation of the Coulomb friction of the motor, on its axis: its expected size; 0: there is none";
    parameter Types.Ratio torque_gain(min=0, max=1e12) = 0.02
      "FilteredRegression: relative standard deviation of the gain of the torque: torque constant, current sensor, gear efficiency; no data show it, so it is part of sigma_std and not estimated";
    parameter Types.Ratio bias(min=0, max=1e12) = 0.05
      "FilteredRegression: standard deviation of a constant torque, as a share of prior.tau_e: bias of the torque, zero of the deformation, uneven friction; 0: there is none";
    parameter Types.Time damping(min=0, max=1e12) = 4e-3
      "FilteredRegression: standard deviation of the damping of the spring over the stiffness prior.tau_e / range.phi; also of encoders read at different times; 0: there is none";
    parameter Types.Ratio load_friction(min=0, max=1e12) = 0.05
      "FilteredRegression: standard deviation of the friction per flexibility torque, and, where prior.tau_coulomb is not 0, per torque of the motor behind the gear; 0: there is none";
    parameter Types.Angle eccentric(min=0, max=1e12) = 3e-4
      "FilteredRegression: standard deviation of the once-per-turn error of the link encoder; 0: there is none";
    parameter Types.Time delay(min=0, max=1e12) = 2e-3
      "FilteredRegression: standard deviation of the delay of the torque against the positions; 0: there is none";
    parameter Types.Time reversal(min=0, max=1e12) = 2e-3
      "FilteredRegression: standard deviation of the delay of the reversals of friction; 0: there is none";
    parameter Types.Ratio power(min=0, max=1e12) = 1
      "FilteredRegression: standard deviation of higher powers of the torque, as a share of prior.tau_e; used if the data ask for them; 0: never";
    parameter Types.Ratio gap(min=0, max=1e12) = 0.02
      "FilteredRegression: standard deviation of the torque lost in a dead zone (backlash), as a share of prior.tau_e; used if the data ask for it; 0: never";
    parameter Types.Ratio hysteresis(min=0, max=1e12) = 0.01
      "FilteredRegression: standard deviation of the torque of hysteresis, as a share of prior.tau_e; used if the data ask for it; 0: never";
    parameter Types.Angle eccentric_motor(min=0, max=1e12) = 1e-4
      "FilteredRegression: standard deviation of the once-per-turn error of the motor encoder, behind the gear; used if the data ask for it; 0: never";
    annotation (Documentation(info="<html><p>Of method FilteredRegression: standard deviations of what it estimates. With 0 a quantity is exact, or there is none of it.</p></html>"));
  end Prior;

  annotation (Documentation(info="<html>
<p>Records, so that the parameters have the names of the FMU: <code>motor.gamma</code>.</p>
</html>"));
end Parameters;
