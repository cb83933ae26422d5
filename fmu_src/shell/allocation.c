#include "allocation.h"

#include <stdlib.h>
#include <string.h>

/* The library that allocated memory must also free it. So allocate and release are used together or not at all. */
static int importer_allocates(const sh_importer *importer)
{
    return importer->allocate != NULL && importer->release != NULL;
}

void *sh_allocate(const sh_importer *importer, size_t size)
{
    void *memory = importer_allocates(importer) ? importer->allocate(1, size) : malloc(size);

    if (memory != NULL) {
        (void)memset(memory, 0, size);
    }
    return memory;
}

void sh_release(const sh_importer *importer, void *memory)
{
    if (memory == NULL) {
        return;
    }
    if (importer_allocates(importer)) {
        importer->release(memory);
    } else {
        free(memory);
    }
}
