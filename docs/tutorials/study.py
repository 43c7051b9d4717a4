# %% [markdown]
# # A study
#
# A study runs many scenarios and makes a table of them: axes, trials a cell, measures. It is a TOML file, which `tiswarm bench` runs.

# %%
from pathlib import Path

_ = Path("study.toml").write_text("""
title = "How hard to pull, and how to avoid"
base = "delft/avoidance-10"
trials = 400
measures = ["success", "time"]

[[axes]]
key = "prey.avoidance"
values = ["spiral", "steer-away", "kitchen-sink"]

[[axes]]
key = "prey.goal"
low = 0.05
high = 0.2
steps = 3
""")
# %%
import subprocess
import sys

command = [sys.executable, "-m", "tiswarm", "bench", "study.toml", "-o", "out/study", "--figures", "heat", "--quiet"]
print(subprocess.run(command, check=True, capture_output=True, text=True).stdout)

# %% [markdown]
# In a terminal that is `tiswarm bench study.toml -o out/study --figures heat`. Every finished cell is on disk at once: a run that was cut short goes
# on when the command is given again. The folder holds the table, what made it, and the figures:

# %%
print(*sorted(file.name for file in Path("out/study").iterdir()), sep="\n")

# %%
from IPython.display import Image, display

for figure in sorted(Path("out/study").glob("*.png")):
    display(Image(figure))

# %% [markdown]
# The table is CSV with a row a cell, for pandas, R or a spreadsheet; here without any of them.

# %%
import csv

with open("out/study/cells.csv", encoding="utf-8") as table:
    rows = list(csv.DictReader(table))
for row in rows:
    print(row["prey.avoidance"], row["prey.goal"], row["success"])

# %% [markdown]
# ## The trial behind a row
#
# `tiswarm film out/study/manifest.json --cell 2 --worst` films the worst trial that cell 2 counted: it is run again, to the same bits.

# %%
command = [sys.executable, "-m", "tiswarm", "film", "out/study/manifest.json", "--cell", "2", "--worst"]
command += ["-o", "worst.mp4", "--size", "640x360", "--fps", "30", "--quality", "draft"]
print(subprocess.run(command, check=True, capture_output=True, text=True).stdout)

# %% [markdown]
# All keys of a study: [Studies](../studies.md).
