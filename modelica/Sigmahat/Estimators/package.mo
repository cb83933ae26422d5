within Sigmahat;
package Estimators "Stiffness of a joint, from encoders and motor torque"
  extends Icons.Package;

  annotation (Documentation(info="<html>
<p>The blocks run a tick of the estimator at <code>startTime</code> and every <code>samplePeriod</code> after it, with the inputs of that
moment; their outputs are the estimate after the tick, and held until the next one. A block has a state of its own; any number of them can
be in a model.</p>
<p><b>Inputs.</b> Positions in rad, that of the motor behind its gear; the torque in N.m on the axis of the motor, before the gear. Connect 0 to
<code>theta_c</code> if no second motor sets the stiffness, and to <code>tau_e_sensor</code> if there is no torque sensor.</p>
<p><b>Parameters.</b> They are checked before the start; one out of its range ends the simulation with a message that names it.</p>
<p><b>Confidence.</b> <code>sigma_std</code> is the standard deviation of <code>sigma</code>; <code>doubt</code> says why an estimate is not
confident. Method Paper2011 makes no such claim: its <code>doubt</code> is NoClaim.</p>
<p>The state of a block is in C. A tool that saves the state of a model and goes back to it, or linearises it, does not see it.</p>
</html>"));
end Estimators;
