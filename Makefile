# make [V=release|debug|asan|tsan|plain] [PORTABLE=1] [CC=cc] [T=suite/case]
#
# Works with GNU make and bmake. They share no way to write "every .c file" rules, so src/rules.sh
# writes build/$(V)/rules.mk with one plain rule an object (and the headers each one includes), and
# this file hands over to it. See `make help`.

V        = release
PORTABLE = 0
PREFIX   = /usr/local
DESTDIR  =
T        =
SPP      = 64
PROBES   =
SHEET    = scenes/all.png

RUN = sh src/rules.sh "$(V)" "$(PORTABLE)" "$(CC)" "$(CFLAGS)" "$(LDFLAGS)" && \
      $(MAKE) -f build/$(V)/rules.mk

all: rules
	+@$(RUN) build/$(V)/rushlight
	@test "$(V)" != release || { cp -p build/release/rushlight rushlight.new && mv -f rushlight.new rushlight; }

check: all
	+@$(RUN) build/$(V)/test
	@build/$(V)/test $(T)

check-long: all
	+@$(RUN) build/$(V)/test
	@build/$(V)/test --long $(T)

bench: all
	+@$(RUN) build/$(V)/bench
	@build/$(V)/bench $(T)

# All benchmarks, or those of T, on one page.
report: all
	+@$(RUN) build/$(V)/bench
	@build/$(V)/bench report bench.html $(T)

demo: all
	./rushlight scenes/cornell.pbrt -o cornell.png

# The probe that scenes are lit by.
probe: all
	./rushlight scenes/parts/probe.pbrt -o scenes/probe.hdr

# Every scene, small, and all of them on one sheet. SPP=n for other than 64 samples a pixel;
# PROBES=dir takes dir/probe.hdr, a map in latitude and longitude, for that of the scenes.
gallery: all
	+@$(RUN) build/$(V)/bench
	@sh bench/gallery.sh build/$(V)/bench $(SHEET) $(SPP) "$(PROBES)"

install: all
	mkdir -p $(DESTDIR)$(PREFIX)/bin
	cp rushlight $(DESTDIR)$(PREFIX)/bin/rushlight

clean:
	rm -rf build rushlight

help:
	@echo "make             build ./rushlight          make check    run the tests"
	@echo "make demo        render cornell.png         make bench    speed and memory tables"
	@echo "make gallery     every scene, on one sheet; PROBES=dir: under dir/probe.hdr, SHEET=x.png"
	@echo "make check-long  the slower proofs          make check T=accel   some of the tests"
	@echo "make bench T=memory|speed|arity|adaptive  tables of [Cline07], also of your own: MODELS=dir make ..."
	@echo "make report      all that bench prints and draws, as bench.html (T=some of it)"
	@echo "make V=debug|asan|tsan|plain  other builds, in build/V"
	@echo "make PORTABLE=1  without tuning to this processor"
	@echo "make install PREFIX=/usr/local, make clean"

rules:

.PHONY: all check check-long bench report demo gallery probe install clean help rules
