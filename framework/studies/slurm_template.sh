#!/usr/bin/env bash
#SBATCH --job-name=@NAME@
#SBATCH --array=@ARRAY@
#SBATCH --ntasks=@RANKS@
#SBATCH --time=12:00:00
#SBATCH --signal=TERM@300
#SBATCH --output=@LOGS@/%A_%a.log
@RUN@
