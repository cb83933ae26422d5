within Sigmahat;
package Sources "Signals for the examples"
  extends Icons.Package;

  block Sine "Sine without offset and phase"
    extends Icons.Block;
    parameter Types.Torque amplitude "Amplitude";
    parameter Real frequency(final quantity="Frequency", final unit="Hz") "Frequency";
    Interfaces.RealOutput y(final unit="N.m") "amplitude sin(2 pi frequency t)"
      annotation (Placement(transformation(extent={{100,-10},{120,10}})));
  equation
    y = amplitude*sin(2*Constants.pi*frequency*time);
    annotation (
      Icon(coordinateSystem(extent={{-100,-100},{100,100}}), graphics={Line(
            points={{-80,0},{-60,45},{-40,65},{-20,45},{0,0},{20,-45},{40,-65},{60,-45},{80,0}}, color={29,53,87},
            thickness=0.5, smooth=Smooth.Bezier)}),
      Documentation(info="<html><p>The torque of a motor in the paper, section VI.</p></html>"));
  end Sine;

  annotation (Documentation(info="<html><p>Any block of the Modelica Standard Library can be connected instead.</p></html>"));
end Sources;
