within Sigmahat.Plants;
function rounded "Angle rounded to the nearest count of an encoder"
  extends Icons.Function;
  input Types.Angle angle "Angle";
  input Types.Ratio counts "Counts per turn; 0: not quantised";
  output Types.Angle measured "What the encoder shows";
protected
  Types.Angle count "Angle of a count";
algorithm
  count := 2*Constants.pi/(if counts > 0 then counts else 1);
  measured := if counts > 0 then count*floor(angle/count + 0.5) else angle;
  annotation (Inline=false, Documentation(info="<html>
<p>It is a function that is not inlined, so that the 40000 steps of a turn are no events.</p>
</html>"));
end rounded;
