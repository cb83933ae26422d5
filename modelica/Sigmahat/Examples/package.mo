within Sigmahat;
package Examples "Models to run at once"
  extends Icons.Package;

  annotation (Documentation(info="<html>
<p>Each plant is in an example, two of them with an estimator. <a href=\"modelica://Sigmahat.Examples.Table1\">Table1</a> is the simulation of the
paper.</p>
</html>"));
end Examples;
