/* insertion.h -- a binary tree of boxes made by inserting primitives one at a time.
 *
 * Source  [Goldsmith87]: the cost of a tree is the sum of the areas of its nodes, since that is how
 *         often rays meet them; each primitive goes where it adds least to the sum. */
#ifndef ACCEL_INSERTION_H
#define ACCEL_INSERTION_H

#include "accel/refs.h"

/* Puts refs[0..n), n >= 1, into the order of the tree's leaves. left, of 2n - 1 numbers, becomes
 * the tree in preorder: the leaves below the left child of each node, 0 for a leaf. So the left
 * child of node k is node k + 1, the right one node k + 2 left[k]. False: out of memory. */
bool insertion_sort(Ref *refs, uint32_t n, uint32_t *left);

#endif
