within Sigmahat.Plants;
function noNoise "No noise, for tools that cannot call C"
  extends partialNoise;
algorithm
  normal := 0;
  annotation (Documentation(info="<html><p>For a tool that can call C, set the variances to 0 instead.</p></html>"));
end noNoise;
