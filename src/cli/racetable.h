/* racetable.h -- what `race` tells: a table for people, CSV for programs, a plot. */
#ifndef CLI_RACETABLE_H
#define CLI_RACETABLE_H

#include "render/race.h"

void race_table_print(const RaceOrder *o, const Race *race);
/* To files. False: reported. */
bool race_csv_write(const RaceOrder *o, const Race *race, const char *path);
bool race_plot_write(const RaceOrder *o, const Race *race, const char *path);

#endif
