"""FilteredRegression on a catalogue of misfits: joints that have what real joints have."""
