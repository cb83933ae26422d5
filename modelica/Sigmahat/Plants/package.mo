within Sigmahat;
package Plants "Joints with encoders, friction, gravity and noisy torque sensors"
  extends Icons.Package;

  annotation (Documentation(info="<html>
<p>Each plant is a page of equations: its transmission, the link (2), one equation (3) for each motor, and what is measured.</p>
<p><b>Encoders.</b> A measured position is rounded to the nearest count at every time, without an event. An estimator reads it at its
ticks. With 0 counts the position is as it is.</p>
<p><b>Noise.</b> Measured torques have white Gaussian noise, which is drawn every <code>noise.samplePeriod</code> and held in between. Sample k
depends on <code>noise.seed</code> and k alone. The numbers are those of the FMU: the same C function draws them. For a tool that cannot call C:
<code>plant(redeclare function drawNoise = Sigmahat.Plants.noNoise)</code>.</p>
<p><b>Coulomb friction</b> is smooth, see <a href=\"modelica://Sigmahat.Constants\">Constants</a>.</p>
</html>"));
end Plants;
