"""The machinery that serves every study: plan, run, store, resume, provenance.

It knows no physics: a study answers to `owtsweep.sweep.study.Study`, and nothing here looks inside
the content of a block. A run is a folder; its shards are immutable and named by the hash of
everything their rows depend on, so that resuming is "the plan minus the shards".
"""
