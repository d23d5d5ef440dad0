/* insertion.c -- a binary tree by insertion. See insertion.h.
 *
 * Idea     From the root a primitive goes down to the child whose branch it makes least larger, and
 *          stops where a new node, for itself and all that is there, adds less than going on.
 * Departs  [Goldsmith87] lets nodes have any number of children and looks at every way down; two
 *          children and the best child at each step make nodes of 32 bytes and a time of n log n.
 *          Primitives come in random order, which they recommend: a sorted one makes poor trees.
 *          Of equal costs the branch with fewer leaves is taken, and no way down is longer than
 *          WAY: input that makes all costs alike would take quadratic time otherwise. */
#include "accel/insertion.h"

#include "base/mem.h"
#include "base/random.h"

enum { WAY = 200 };

/* Leaves are the first n nodes, inner ones follow. */
typedef struct {
    Box box;
    uint32_t child[2];
    uint32_t leaves;
} Node;

typedef struct {
    Node *node;                 /* owned */
    uint32_t n, count;          /* leaves in all, nodes so far */
} Tree;

static bool is_leaf(const Tree *t, uint32_t k) { return k < t->n; }

/* What the sum of areas grows by when a box joins the branch of node k, at least. */
static float branch_cost(const Tree *t, uint32_t k, Box b)
{
    float joined = box_area(box_join(t->node[k].box, b));
    return is_leaf(t, k) ? joined : joined - box_area(t->node[k].box);
}

/* The child to go on with, or 2: stop here. */
static int way_down(const Tree *t, const Node *at, Box b)
{
    float here = box_area(box_join(at->box, b)), grown = here - box_area(at->box);
    float left = branch_cost(t, at->child[0], b), right = branch_cost(t, at->child[1], b);
    int best = right < left || (right == left && t->node[at->child[1]].leaves <
                                                 t->node[at->child[0]].leaves);

    return here < grown + (best ? right : left) ? 2 : best;
}

/* Leaf k joins the tree below *at. */
static void insert(Tree *t, uint32_t *at, uint32_t k)
{
    Box b = t->node[k].box;
    Node *new = &t->node[t->count];

    for (int way = 0; !is_leaf(t, *at) && way < WAY; way++) {
        Node *node = &t->node[*at];
        int side = way_down(t, node, b);
        if (side == 2)
            break;
        node->box = box_join(node->box, b);
        node->leaves++;
        at = &node->child[side];
    }
    new->box = box_join(t->node[*at].box, b);
    new->child[0] = *at;
    new->child[1] = k;
    new->leaves = t->node[*at].leaves + 1;
    *at = t->count++;
}

static void shuffle(uint32_t *order, uint32_t n)
{
    Rng rng = rng_seed(n);

    for (uint32_t i = 0; i < n; i++)
        order[i] = i;
    for (uint32_t i = n; i > 1; i--) {
        uint32_t j = rng_below(&rng, i), swap = order[i - 1];
        order[i - 1] = order[j];
        order[j] = swap;
    }
}

/* Preorder; `stack` has room for n nodes, since each that waits is another's right child. */
static void flatten(const Tree *t, uint32_t root, uint32_t *stack, const Ref *from, Ref *refs,
                    uint32_t *left)
{
    size_t top = 0, leaf = 0, place = 0;

    stack[top++] = root;
    while (top) {
        uint32_t k = stack[--top];
        if (is_leaf(t, k)) {
            left[place++] = 0;
            refs[leaf++] = from[k];
        } else {
            left[place++] = t->node[t->node[k].child[0]].leaves;
            stack[top++] = t->node[k].child[1];
            stack[top++] = t->node[k].child[0];
        }
    }
}

bool insertion_sort(Ref *refs, uint32_t n, uint32_t *left)
{
    Tree t = { MEM_ARRAY(Node, 2 * (size_t)n - 1), n, n };
    uint32_t *order = MEM_ARRAY(uint32_t, n), root;
    Ref *from = MEM_ARRAY(Ref, n);
    bool ok = t.node && order && from;

    if (ok) {
        shuffle(order, n);
        for (uint32_t i = 0; i < n; i++) {
            from[i] = refs[i];
            t.node[i].box = refs[i].box;
            t.node[i].leaves = 1;
        }
        root = order[0];
        for (uint32_t i = 1; i < n; i++)
            insert(&t, &root, order[i]);
        flatten(&t, root, order, from, refs, left);
    }
    mem_free(t.node);
    mem_free(order);
    mem_free(from);
    return ok;
}
