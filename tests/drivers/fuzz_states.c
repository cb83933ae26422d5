#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

#include "drive.h"
#include "fmi_calls.h"

/* Serialises a state, maybe damages it, and reads it back. */
static void serialise(sequence *s, void **state)
{
    void *copy = NULL;
    sh_status status;
    uint8_t *bytes;
    size_t size = 0, length;
    int damaged = 0;

    if (fmi_state_size(s->instance, *state, &size) != SH_OK) {
        return;
    }
    bytes = memory(size);
    if (seldom(s, 16)) {
        check(fmi_serialize_state(s->instance, *state, bytes, size - 1) == SH_ERROR,
              "a state went into too little room");
    }
    check(fmi_serialize_state(s->instance, *state, bytes, size) == SH_OK,
          "a good state was not serialised");
    length = size;
    if (below(s, 2)) {
        const unsigned flip = byte(s);
        bytes[bits(s) % size] ^= (uint8_t)flip;
        damaged = flip != 0;
    }
    if (seldom(s, 4)) { /* truncated, in a block of exactly this size */
        length = (below(s, 2) ? bits(s) : byte(s)) % size;
        bytes = realloc(bytes, length > 0 ? length : 1);
        check(bytes != NULL, "out of memory");
    }
    status = fmi_deserialize_state(s->instance, bytes, length, &copy);
    check(status == SH_ERROR || (!damaged && length == size), "a spoilt state was taken");
    if (status == SH_OK) {
        fmi_free_state(s->instance, state);
        *state = copy;
    }
    free(bytes);
}

static void restore(sequence *s, unsigned slot)
{
    unsigned char *block = s->states[slot];

    if (block != NULL && seldom(s, 32)) {
        unsigned char *place = block + below(s, 12); /* of what says whose state it is */
        *place ^= 1;
        check(fmi_set_state(s->instance, block) == SH_ERROR, "a foreign state was taken");
        *place ^= 1;
    }
    if (fmi_set_state(s->instance, block) == SH_OK) {
        s->stop_time = s->stop_times[slot];
        s->time = fmi_time(s->instance, s->time);
    }
}

void use_states(sequence *s)
{
    const unsigned slot = below(s, SLOTS);

    switch (below(s, 5)) {
    case 0:
    case 1:
        if (fmi_get_state(s->instance, &s->states[slot]) == SH_OK) {
            s->stop_times[slot] = s->stop_time;
        }
        break;
    case 2:
        restore(s, slot);
        break;
    case 3:
        fmi_free_state(s->instance, &s->states[slot]);
        break;
    default:
        serialise(s, &s->states[slot]);
    }
}
