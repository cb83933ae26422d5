within Sigmahat.Plants;
pure function standardNormal "The noise of the FMUs: white and Gaussian, without a state"
  extends partialNoise;

  external "C" normal = sigmahat_standard_normal(seed, k, channel)
    annotation (
      Include="#include \"sigmahat_noise.c\"",
      IncludeDirectory="modelica://Sigmahat/Resources/C-Sources");
  annotation (Documentation(info="<html>
<p>Sample k of a channel depends on the seed, on k and on the channel alone, and is the same number on every system.</p>
</html>"));
end standardNormal;
