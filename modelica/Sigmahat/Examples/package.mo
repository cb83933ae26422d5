within Sigmahat;
package Examples "Models to run at once"
  extends Icons.Package;

  annotation (Documentation(info="<html>
<p>One example for each plant, and two with estimators. <a href=\"modelica://Sigmahat.Examples.Table1\">Table1</a> is the simulation of the
paper.</p>
</html>"));
end Examples;
