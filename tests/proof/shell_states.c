/* The de-serialiser: any bytes of any length, then the state that they make, then a step. */
#include "saved_state.h"
#include "shell_invariant.h"
#include "simulation.h"

enum { SIZE = HEADER + sizeof model }; /* of a saved state */

static const sh_importer NONE = {NULL, NULL, NULL, NULL};
static const sh_importer OWN = {NULL, NULL, allocate, release};

/* Bytes of any content that are too few or too many: a shorter array than `least` cannot be meant. */
static void of_another_size(size_t length, size_t least, size_t most)
{
    const size_t size = Frama_C_size_t_interval(least, most);
    void *state = NULL;

    any_instance(course_of(0), NONE);
    sh_deserialize_state(&instance, any_bytes(length), size, &state, "proof");
    //@ assert refused: state == \null;
}

/* A state of the right size. The place in its simulation is given; the other bytes may have any value. */
static void *block_of(unsigned state, int outputs_stale)
{
    return with_course(any_bytes(SIZE), state, outputs_stale);
}

static void of_course(course here, sh_importer importer)
{
    const void *bytes = block_of(here.state, here.outputs_stale);
    void *state = NULL;

    any_instance(course_of(0), importer);
    if (sh_deserialize_state(&instance, bytes, SIZE, &state, "proof") != SH_OK) {
        return;
    }
    if (sh_restore_state(&instance, state, "proof") == SH_OK) {
        //@ assert taken: instance.state == here.state;
        expect(importer);
        if (here.state != SH_INITIALIZATION || sh_end_initialization(&instance, "proof") == SH_OK) {
            sh_communication_step(&instance, any_real(), any_real(), "proof");
        }
    }
    sh_free_state(&instance, &state, "proof");
    //@ assert freed: state == \null;
}

/* A serialised state whose course does not exist. */
static void of_no_course(unsigned state)
{
    void *made = NULL;

    any_instance(course_of(0), NONE);
    if (sh_deserialize_state(&instance, block_of(state, any_choice()), SIZE, &made, "proof") ==
        SH_OK) {
        //@ assert refused: \false;
    }
}

int main(void)
{
    int i;

    of_another_size(0, 0, HEADER - 1);
    of_another_size(HEADER, HEADER, SIZE - 1);
    of_another_size(HEADER, SIZE + 1, SIZE_MAX);
    //@ loop unroll 16;
    for (i = 0; i < COURSES / 2; ++i) { /* the other half differs in parameters_unchecked only */
        of_course(course_of(i), i % 2 == 0 ? NONE : OWN);
    }
    of_no_course(0);
    of_no_course(3);
    of_no_course((unsigned)Frama_C_interval(5, 7));
    of_no_course(Frama_C_unsigned_int_interval(9, UINT32_MAX));
    //@ assert reached: \true;
    return 0;
}
