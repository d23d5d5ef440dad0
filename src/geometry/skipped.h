/* skipped.h -- what a reader of meshes or materials left out or made do with, counted and told in
 * one warning a file: a file with a million odd lines must not print a million messages. */
#ifndef GEOMETRY_SKIPPED_H
#define GEOMETRY_SKIPPED_H

#include "base/text.h"

typedef enum {
    SKIPPED_KEYWORD,            /* a statement that is not known or not supported */
    SKIPPED_FACE,               /* fewer than three corners */
    SKIPPED_ATTRIBUTE,          /* index of a normal or texture coordinate that is not there */
    SKIPPED_CARE,               /* polygon too large to be cut with care, cut as a fan */
    SKIPPED_SPECTRUM,           /* colour given as a spectrum or in CIE XYZ */
    SKIPPED_OPTION,             /* map with an option that is not known */
    SKIPPED_ORPHAN,             /* material statement before the first newmtl */
    SKIPPED_TAIL,               /* bytes after the last element */
    SKIPPED_ALL,                /* there is no triangle in the file */
    SKIPPED_KINDS
} SkippedKind;

/* {0} is empty. */
typedef struct {
    Place  first;
    size_t n[SKIPPED_KINDS];
    char   word[32];            /* the first SKIPPED_KEYWORD */
} Skipped;

void skipped_note(Skipped *s, SkippedKind kind, Place at);
void skipped_keyword(Skipped *s, Place at, Word keyword);

/* Prints the warning, if there is anything to tell. True if the caller may go on. */
bool skipped_report(const Skipped *s);

#endif
