within Sigmahat.Plants;
partial function partialNoise "Interface of a function that draws noise"
  extends Icons.Function;
  input Integer seed "Seed of the noise";
  input Integer k "Number of the sample, from 0";
  input Integer channel "Number of the signal, from 0; signals are independent";
  output Real normal "Standard normal number";
  annotation (Documentation(info="<html><p>Interface of the functions that can be chosen.</p></html>"));
end partialNoise;
