within Sigmahat.Estimators;
partial block Settings "Parameters of an estimator other than those of motors"
  parameter Types.Time samplePeriod(min=1e-9) = 1e-3 "Sample period T";
  parameter Types.Time startTime = 0 "Time of the first tick";
  parameter Types.Method method = Types.Method.Paper2011 "How the stiffness is estimated";
  parameter Types.Modality modality = Types.Modality.Residual "What feeds the regression";
  parameter Parameters.Limit limit "When the estimate is confident";
  parameter Parameters.Encoder encoder "Resolution of the encoders" annotation (Dialog(group="Joint"));
  parameter Parameters.SetPoint setPoint "Set-point of the stiffness" annotation (Dialog(group="Joint"));
  parameter Parameters.Nominal nominal "Nominal torque of modality Model" annotation (Dialog(group="Joint"));
  parameter Parameters.Noise noise "Noise of the torques" annotation (Dialog(group="Joint"));
  parameter Parameters.Rls rls "Regression" annotation (Dialog(group="Regression"));
  parameter Types.Deformation deformation = Types.Deformation.Raw
    "Paper2011: which deformation enters the regression; FilteredRegression: always Raw"
    annotation (Dialog(tab="Paper2011"));
  parameter Parameters.Residual residual "Residual" annotation (Dialog(tab="Paper2011"));
  parameter Parameters.Filter filter "Kalman filter" annotation (Dialog(tab="Paper2011"));
  parameter Parameters.Torque torque "How the torque is held" annotation (Dialog(tab="FilteredRegression"));
  parameter Parameters.Regression regression "Filter and memory" annotation (Dialog(tab="FilteredRegression"));
  parameter Parameters.Range range "Ranges of the operating point" annotation (Dialog(tab="FilteredRegression"));
  parameter Parameters.Prior prior "What is not known exactly" annotation (Dialog(tab="FilteredRegression"));
  annotation (
    Icon(coordinateSystem(extent={{-100,-100},{100,100}})),
    Documentation(info="<html>
<p>The start values are those of the AwAS, section VI.A.</p>
</html>"));
end Settings;
