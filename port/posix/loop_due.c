/* SPDX-License-Identifier: MIT */
#include "internal/posix_loop.h"

uint64_t fathom_loop_now_us(const fathom_loop_t *loop)
{
    return loop->config.now_us != NULL ? loop->config.now_us(loop->config.ctx) : fathom_posix_now_us();
}

/*
 * The sources by the time when they are due: a skew heap, which needs no memory but in its nodes. What is added or taken
 * out merges two heaps along their right sides, and swaps the children on the way: n of these cost n log n.
 */
static fathom_loop_source_t *merge(fathom_loop_source_t *one, fathom_loop_source_t *other,
                                   fathom_loop_source_t *parent)
{
    fathom_loop_source_t *root = NULL;
    fathom_loop_source_t **at = &root;
    while (one != NULL && other != NULL) {
        if (other->due_us < one->due_us) {
            fathom_loop_source_t *const later = one;
            one = other;
            other = later;
        }
        fathom_loop_source_t *const rest = one->right;
        *at = one;
        one->parent = parent;
        one->right = one->left;
        parent = one;
        at = &one->left;
        one = rest;
    }
    *at = one != NULL ? one : other;
    if (*at != NULL) (*at)->parent = parent;
    return root;
}

void fathom_loop_due_never(fathom_loop_source_t *source)
{
    if (!source->is_due) return;
    fathom_loop_source_t *const parent = source->parent;
    fathom_loop_source_t *const rest = merge(source->left, source->right, parent);
    if (parent == NULL)
        source->loop->due = rest;
    else if (parent->left == source)
        parent->left = rest;
    else
        parent->right = rest;
    source->parent = source->left = source->right = NULL;
    source->is_due = false;
}

void fathom_loop_due_at(fathom_loop_source_t *source, uint64_t time_us)
{
    fathom_loop_due_never(source);
    source->due_us = time_us;
    source->is_due = true;
    source->loop->due = merge(source->loop->due, source, NULL);
}
