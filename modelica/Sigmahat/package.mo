within ;
package Sigmahat "Stiffness of flexible robot joints: estimators, and joints to try them on"
  extends Icons.Package;

  annotation (
    version="0.1.0",
    preferredView="info",
    Documentation(info="<html>
<p>This library estimates the stiffness of a flexible robot joint while the joint moves, from encoders and motor torque alone.
It contains the method of F. Flacco, A. De Luca, I. Sardellitti, N. Tsagarakis, <em>Robust Estimation of Variable Stiffness in
Flexible Joints</em>, IROS 2011, and a second one for joints whose friction and inertia are not known well. Equation numbers in this
library are those of the paper.</p>
<table border=\"1\" cellspacing=\"0\" cellpadding=\"2\">
<tr><th>package</th><th>contents</th></tr>
<tr><td><a href=\"modelica://Sigmahat.Estimators\">Estimators</a></td><td>the estimators as blocks with a sample period; they call a
library in C99, whose sources are in <code>Resources/C-Sources</code></td></tr>
<tr><td><a href=\"modelica://Sigmahat.Plants\">Plants</a></td><td>joints with encoders, friction, gravity and noisy torque sensors, as
equations</td></tr>
<tr><td><a href=\"modelica://Sigmahat.Examples\">Examples</a></td><td>models to run at once; begin with
<a href=\"modelica://Sigmahat.Examples.Table1\">Table1</a></td></tr>
</table>
<h4>Names</h4>
<p>Variables have the names, units and start values of the FMUs of the same names. Groups of parameters are records, so
<code>motor.gamma</code> is written as in the FMU. Two groups have names that are keywords of Modelica:</p>
<table border=\"1\" cellspacing=\"0\" cellpadding=\"2\">
<tr><th>FMU</th><th>this library</th></tr>
<tr><td><code>initial.q</code>, ...</td><td><code>init.q</code>, ...</td></tr>
<tr><td><code>model.k_s</code>, ...</td><td><code>nominal.k_s</code>, ...</td></tr>
<tr><td><code>eta[i,j]</code>, <code>rls.eta_0[i,j]</code>, from 0</td><td><code>eta[i+1,j+1]</code>, <code>rls.eta_0[i+1,j+1]</code></td></tr>
</table>
<h4>No dependency</h4>
<p>The library does not use the Modelica Standard Library, so that it loads beside every version of it, and in tools that do not have it.
Its connectors are declared as those of <code>Modelica.Blocks.Interfaces</code>, and can be connected with them; its units are those of
<code>Modelica.Units.SI</code>.</p>
<h4>C sources</h4>
<p>The functions of the estimators and of the noise name their sources in the annotation <code>Include</code>, and no binary in
<code>Library</code>: the tool compiles them together with the model, so that they work on every system that the tool works on. They need a
compiler for C99. Each external function has its own file, and no function of C is defined in two of them.</p>
<h4>Licence</h4>
<p>BSD-2-Clause, Copyright (c) 2026, the sigmahat authors.</p>
</html>"));
end Sigmahat;
