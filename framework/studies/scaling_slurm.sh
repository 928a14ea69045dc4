#!/usr/bin/env bash
#SBATCH --job-name=@NAME@
#SBATCH --array=@ARRAY@
#SBATCH --ntasks=@RANKS@
#SBATCH --exclusive
#SBATCH --time=02:00:00
#SBATCH --output=@LOGS@/%A_%a.log
@RUN@
