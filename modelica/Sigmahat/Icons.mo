within Sigmahat;
package Icons "Drawings: a motor is a disk, the link a bar, a transmission a spring between them; an estimate has a hat"

  partial package Package "Icon of a package"
    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={
          Rectangle(extent={{-100,100},{100,-100}}, radius=25, lineColor={29,53,87}, fillColor={255,255,255},
            fillPattern=FillPattern.Solid),
          Line(points={{-40,0},{-28,0},{-23,14},{-13,-14},{-3,14},{7,-14},{17,14},{27,-14},{32,0},{44,0}},
            color={193,68,14}, thickness=1),
          Ellipse(extent={{-84,28},{-28,-28}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid),
          Rectangle(extent={{48,44},{70,-44}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid)}),
      Documentation(info="<html><p>Extended by packages.</p></html>"));
  end Package;

  partial record Record "Icon of a group of parameters"
    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={
          Rectangle(extent={{-100,60},{100,-60}}, lineColor={29,53,87}, fillColor={255,255,255},
            fillPattern=FillPattern.Solid),
          Line(points={{-100,20},{100,20}}, color={29,53,87}),
          Line(points={{-100,-20},{100,-20}}, color={29,53,87}),
          Line(points={{0,60},{0,-60}}, color={29,53,87})}),
      Documentation(info="<html><p>Extended by records.</p></html>"));
  end Record;

  partial function Function "Icon of a function"
    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={
          Ellipse(extent={{-100,100},{100,-100}}, lineColor={29,53,87}, fillColor={255,255,255},
            fillPattern=FillPattern.Solid),
          Text(extent={{-80,70},{80,-70}}, textColor={29,53,87}, textString="f")}),
      Documentation(info="<html><p>Extended by functions.</p></html>"));
  end Function;

  partial model Example "Icon of a model that can be run"
    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={
          Ellipse(extent={{-100,100},{100,-100}}, lineColor={29,53,87}, fillColor={255,255,255},
            fillPattern=FillPattern.Solid),
          Polygon(points={{-36,60},{64,0},{-36,-60},{-36,60}}, lineColor={193,68,14}, fillColor={193,68,14},
            fillPattern=FillPattern.Solid)}),
      Documentation(info="<html><p>Extended by examples.</p></html>"));
  end Example;

  partial class Block "Frame of a block or a plant, with its name"
    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={
          Rectangle(extent={{-100,100},{100,-100}}, lineColor={29,53,87}, fillColor={255,255,255},
            fillPattern=FillPattern.Solid),
          Text(extent={{-150,140},{150,105}}, textColor={0,0,255}, textString="%name")}),
      Documentation(info="<html><p>Extended by blocks and plants.</p></html>"));
  end Block;

  partial class Joint "Motor, spring and link"
    extends Block;
    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={
          Line(points={{-40,0},{-28,0},{-23,14},{-13,-14},{-3,14},{7,-14},{17,14},{27,-14},{32,0},{44,0}},
            color={193,68,14}, thickness=1),
          Ellipse(extent={{-84,28},{-28,-28}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid),
          Rectangle(extent={{48,44},{70,-44}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid)}),
      Documentation(info="<html><p>Extended by joints with one transmission.</p></html>"));
  end Joint;

  partial class Lever "A spring at an adjustable lever arm on the axis of the motor"
    extends Block;
    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={
          Line(points={{-48,-60},{-48,76}}, color={29,53,87}, thickness=2),
          Ellipse(extent={{-76,-32},{-20,-88}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid),
          Line(points={{-48,32},{-28,32},{-23,46},{-13,18},{-3,46},{7,18},{17,46},{27,18},{32,32},{48,32}},
            color={193,68,14}, thickness=1),
          Line(points={{-78,76},{-78,-12}}, color={29,53,87}, arrow={Arrow.Filled,Arrow.Filled}),
          Rectangle(extent={{48,76},{70,-76}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid)}),
      Documentation(info="<html><p>Extended by the AwAS.</p></html>"));
  end Lever;

  partial class Antagonists "Two motors, two springs, one link"
    extends Block;
    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={
          Line(points={{-40,46},{-28,46},{-23,60},{-13,32},{-3,60},{7,32},{17,60},{27,32},{32,46},{44,46}},
            color={193,68,14}, thickness=1),
          Line(points={{-40,-46},{-28,-46},{-23,-32},{-13,-60},{-3,-32},{7,-60},{17,-32},{27,-60},{32,-46},{44,-46}},
            color={193,68,14}, thickness=1),
          Ellipse(extent={{-80,70},{-32,22}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid),
          Ellipse(extent={{-80,-22},{-32,-70}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid),
          Rectangle(extent={{48,76},{70,-76}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid)}),
      Documentation(info="<html><p>Extended by antagonistic joints.</p></html>"));
  end Antagonists;

  partial class Estimator "Sigma with a hat over a joint"
    extends Block;
    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={
          Ellipse(extent={{-30,40},{18,-8}}, lineColor={29,53,87}, lineThickness=2),
          Line(points={{-6,40},{38,40}}, color={29,53,87}, thickness=2),
          Line(points={{-28,58},{0,84},{28,58}}, color={29,53,87}, thickness=2),
          Line(points={{-40,-52},{-28,-52},{-23,-38},{-13,-66},{-3,-38},{7,-66},{17,-38},{27,-66},{32,-52},{44,-52}},
            color={193,68,14}, thickness=1),
          Ellipse(extent={{-80,-30},{-36,-74}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid),
          Rectangle(extent={{48,-20},{66,-84}}, lineColor={29,53,87}, fillColor={29,53,87},
            fillPattern=FillPattern.Solid)}),
      Documentation(info="<html><p>Extended by estimators.</p></html>"));
  end Estimator;

  annotation (
    Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={
        Rectangle(extent={{-100,100},{100,-100}}, radius=25, lineColor={29,53,87}, fillColor={255,255,255},
          fillPattern=FillPattern.Solid),
        Ellipse(extent={{-60,60},{10,-10}}, lineColor={193,68,14}, fillColor={193,68,14},
          fillPattern=FillPattern.Solid),
        Rectangle(extent={{-10,10},{60,-60}}, lineColor={29,53,87}, fillColor={29,53,87},
          fillPattern=FillPattern.Solid)}),
    Documentation(info="<html><p>Classes without equations.</p></html>"));
end Icons;
