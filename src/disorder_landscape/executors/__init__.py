"""Where many tasks are carried out: processes of this machine, jobs of Slurm, a Dask cluster."""
