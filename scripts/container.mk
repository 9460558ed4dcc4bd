# The container's front: installed there as GNUmakefile, which make reads before Makefile.
#
# Docker makes a mounted folder that is not there yet (out in -v "$PWD/out:/artifact/build") as root,
# and a user set in the Dockerfile could not write to it.  So the container starts as root, and root
# does just one thing: it gives build/ to the user `landscape`, or finds out to which user it already
# belongs, and becomes that user for good.  With `docker run --user …` nothing ever runs as root.
ifneq ($(shell id -u),0)

ifneq ($(shell test -w build && echo writable),writable)
$(error build/ must be writable for user $(shell id -u), but it is not: make the mounted folder first (mkdir out))
endif
include Makefile

else

GOALS := $(or $(MAKECMDGOALS),help)
.PHONY: unprivileged $(GOALS)
$(GOALS): unprivileged ; @:

unprivileged:
	@[ "$$(stat -c %u build)" != 0 ] || chown landscape:landscape build
	@exec setpriv --reuid "$$(stat -c %u build)" --regid "$$(stat -c %g build)" --clear-groups \
	  --inh-caps=-all --no-new-privs $(MAKE) --no-print-directory $(MAKECMDGOALS)

endif
