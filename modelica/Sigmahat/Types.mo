within Sigmahat;
package Types "Units and choices"
  extends Icons.Package;

  type Angle = Real (final quantity="Angle", final unit="rad", displayUnit="deg") "Angle";
  type AngularVelocity = Real (final quantity="AngularVelocity", final unit="rad/s") "Angular velocity";
  type AngleVariance = Real (final unit="rad2") "Variance of an angle";
  type AccelerationVariance = Real (final unit="rad2/s4") "Variance of an angular acceleration";
  type Torque = Real (final quantity="Torque", final unit="N.m") "Torque";
  type TorqueVariance = Real (final unit="N2.m2") "Variance of a torque";
  type Inertia = Real (final quantity="MomentOfInertia", final unit="kg.m2") "Moment of inertia";
  type Friction = Real (final quantity="RotationalDampingConstant", final unit="N.m.s/rad") "Viscous friction";
  type Stiffness = Real (final quantity="RotationalSpringConstant", final unit="N.m/rad") "Stiffness of a joint";
  type CubicStiffness = Real (final unit="N.m/rad3") "Torque per cube of a deformation";
  type SpringStiffness = Real (final quantity="TranslationalSpringConstant", final unit="N/m") "Stiffness of a spring";
  type PerAngle = Real (final unit="1/rad") "Something without unit per angle";
  type Length = Real (final quantity="Length", final unit="m") "Length";
  type Lead = Real (final unit="m/rad") "Length per angle";
  type Time = Real (final quantity="Time", final unit="s") "Time";
  type Rate = Real (final unit="1/s") "Something without unit per time";
  type Ratio = Real (final unit="1") "Number without unit";

  type Method = enumeration(
      Paper2011 "Kalman filter, residual and recursive least squares of the paper",
      FilteredRegression
        "One filter for all signals; the errors of the motor data are estimated together with the stiffness")
    "How the stiffness is estimated";

  type Modality = enumeration(
      Residual "The residual gamma r_e, (8): no torque sensor needed",
      Sensor "A torque sensor: input tau_e_sensor",
      Model "The nominal torque (28) at the measured positions") "What feeds the regression";

  type FilterKind = enumeration(
      ModifiedKalman "Kinematic Kalman filter whose measurement variance depends on the velocity, (11)",
      Kalman "Kinematic Kalman filter with constant measurement variance filter.R",
      FiniteDifference "Difference of two samples, no filter") "How the motor velocity is obtained";

  type Weighting = enumeration(
      Normalized "|x'| / w_s - 1: the variance falls above one count per sample",
      AsPrinted "|x'| w_s - 1: the formula as printed, which is not dimensionless")
    "How (11) compares velocity and encoder resolution";

  type Deformation = enumeration(
      Raw "q - theta as measured",
      Filtered "Both positions through the filter") "Which deformation enters the regression";

  type RlsKind = enumeration(
      Enhanced "Stability factor a(k) of (27)",
      Standard "a = 1, (14)",
      ConstantFactor "a = rls.a in (25)") "Recursive least squares";

  type Doubt = enumeration(
      None "The estimate is confident",
      NoClaim "The method computes no uncertainty that contains all errors: Paper2011",
      NotExcited "sigma_std is too large: the motion was too small or too short",
      Misfit "sigma_std is too large: the data contradict the model",
      OutOfRange "The deformation is far beyond range.phi",
      FrictionOutsidePrior "D_theta_hat is beyond three standard deviations of prior.D_theta",
      InertiaOutsidePrior "B_hat is beyond three standard deviations of prior.B",
      NegativeStiffness "sigma is below 0")
    "Why the estimate is not confident; of several reasons the one that stands last";

  annotation (Documentation(info="<html>
<p>Units, with the quantities of <code>Modelica.Units.SI</code> where that has them, and the choices of the estimators, with the items of the
FMUs.</p>
</html>"));
end Types;
