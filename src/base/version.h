/* version.h -- the program's version: files that only the same program can go on from name it. */
#ifndef BASE_VERSION_H
#define BASE_VERSION_H

#define RUSHLIGHT_VERSION "0.1.0"

#endif
