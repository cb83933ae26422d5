within Sigmahat;
package Interfaces "Connectors"
  extends Icons.Package;

  connector RealInput = input Real "Signal of type Real, into a block" annotation (
      defaultComponentName="u",
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={Polygon(
            points={{-100,100},{100,0},{-100,-100},{-100,100}},
            lineColor={0,0,127},
            fillColor={0,0,127},
            fillPattern=FillPattern.Solid)}),
      Documentation(info="<html><p>As <code>Modelica.Blocks.Interfaces.RealInput</code>.</p></html>"));

  connector RealOutput = output Real "Signal of type Real, out of a block" annotation (
      defaultComponentName="y",
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={Polygon(
            points={{-100,100},{100,0},{-100,-100},{-100,100}},
            lineColor={0,0,127},
            fillColor={255,255,255},
            fillPattern=FillPattern.Solid)}),
      Documentation(info="<html><p>As <code>Modelica.Blocks.Interfaces.RealOutput</code>.</p></html>"));

  connector BooleanOutput = output Boolean "Signal of type Boolean, out of a block" annotation (
      defaultComponentName="y",
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={Polygon(
            points={{-100,100},{100,0},{-100,-100},{-100,100}},
            lineColor={255,0,255},
            fillColor={255,255,255},
            fillPattern=FillPattern.Solid)}),
      Documentation(info="<html><p>As <code>Modelica.Blocks.Interfaces.BooleanOutput</code>.</p></html>"));

  annotation (Documentation(info="<html>
<p>Connectors that fit those of the Modelica Standard Library.</p>
</html>"));
end Interfaces;
