"""environments: trials stepped from outside: actions in, observations and rewards out, for PettingZoo and Gymnasium, too."""
