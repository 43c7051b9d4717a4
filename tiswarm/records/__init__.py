"""Records: what comes out of a run: outcomes of a batch, the path of a trial."""
