#!/usr/bin/env bash
#SBATCH --job-name=@NAME@
#SBATCH --array=@ARRAY@
#SBATCH --ntasks=@RANKS@
#SBATCH --exclusive
#SBATCH --time=02:00:00
#SBATCH --output=@LOGS@/%A_%a.log
printf '{"cpu": "%s", "cores_of_machine": %s}\n' "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)" \
  "$(nproc --all)" >@LOGS@/machine.json
@RUN@
