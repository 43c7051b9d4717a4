"""environments: trials stepped from outside: actions in, observations and rewards out; PettingZoo's and Gymnasium's interfaces."""
