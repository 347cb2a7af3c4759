"""The machinery that serves every study: plan, run, store, resume, provenance.

It knows no physics: a study implements `owtsweep.sweep.study.Study`, and nothing here looks inside
the content of a block. A run is a folder. Its shards are immutable files, each named by the hash of
everything that its rows depend on. So resuming a run means computing "the plan minus the shards".
"""
