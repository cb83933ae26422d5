within Sigmahat.Plants;
block TorqueNoise "Noise of the measured torques of one motor, (32), (33)"
  extends Icons.Block;
  parameter Integer side(min=1) = 1 "Which motor it is, from 1: each has noise of its own";
  parameter Types.TorqueVariance tau_variance(min=0) = 1e-5
    "Variance of the noise of a measured motor torque, (32)";
  parameter Types.TorqueVariance tau_e_variance(min=0) = 1e-3
    "Variance of the noise of a measured flexibility torque, (33)";
  parameter Integer seed = 1 "Seed of the noise: one seed is one sequence of samples, on every platform";
  parameter Types.Time samplePeriod(min=1e-9) = 1e-3
    "Time between two samples of the noise, the first of them at time 0; it is held in between";
  replaceable function drawNoise = standardNormal constrainedby partialNoise "What draws a number";
  discrete output Types.Torque tau(start=0, fixed=true) "Noise of the motor torque";
  discrete output Types.Torque tau_e(start=0, fixed=true) "Noise of the flexibility torque";
protected
  discrete Integer k(start=-1, fixed=true) "Number of the sample";
equation
  when sample(0, samplePeriod) then
    k = pre(k) + 1;
    tau = sqrt(tau_variance)*drawNoise(seed, k, 2*side - 2);
    tau_e = sqrt(tau_e_variance)*drawNoise(seed, k, 2*side - 1);
  end when;
  annotation (
    Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={Line(
          points={{-80,0},{-60,0},{-60,40},{-40,40},{-40,-20},{-20,-20},{-20,60},{0,60},{0,-50},{20,-50},{20,10},{40,10},
              {40,-30},{60,-30},{60,20},{80,20}},
          color={193,68,14},
          thickness=0.5)}),
    Documentation(info="<html>
<p>Set <code>samplePeriod</code> to that of the estimator, so that the noise of its samples is white. Sample 0 is drawn at the time 0, or at
the first multiple of the sample period after the start.</p>
</html>"));
end TorqueNoise;
