"""FilteredRegression on a catalogue of misfits: effects of real joints that no model has."""
