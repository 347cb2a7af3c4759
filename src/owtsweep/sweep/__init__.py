"""The machinery of sweeps that serves every study: it plans, runs, stores and resumes.

The machinery knows no physics. A study implements `owtsweep.sweep.study.Study` and plans blocks,
the units of work. Nothing in this package looks inside the content of a block. A run is a folder.
A shard is an immutable file in the run's folder. A shard holds the rows of one block, and is named
by a hash of everything on which the rows depend. So resuming a run means computing "the plan
minus the shards".
"""
