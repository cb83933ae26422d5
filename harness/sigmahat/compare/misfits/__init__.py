"""MatchedFilter on joints that have what its model does not describe: a catalogue of misfits."""
