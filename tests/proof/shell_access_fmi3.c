/* FMI 3.0: a variable of every kind in every function, in arrays of exactly the announced length. The
 * number of values is right, or any other.
 */
#include "fmi3Functions.h"
#include "shell_access.h"

static void access(sh_instance *instance, const fmi3ValueReference *vr, size_t n, size_t length,
                   size_t count)
{
    void *reals = any_bytes(length * sizeof(fmi3Float64));
    void *longs = any_bytes(length * sizeof(fmi3Int64));
    void *integers = any_bytes(length * sizeof(fmi3Int32));
    void *booleans = any_bytes(length * sizeof(fmi3Boolean));

    fmi3GetFloat64(instance, vr, n, reals, count);
    fmi3SetFloat64(instance, vr, n, reals, count);
    fmi3GetInt64(instance, vr, n, longs, count);
    fmi3SetInt64(instance, vr, n, longs, count);
    fmi3GetInt32(instance, vr, n, integers, count);
    fmi3SetInt32(instance, vr, n, integers, count);
    fmi3GetBoolean(instance, vr, n, booleans, count);
    fmi3SetBoolean(instance, vr, n, booleans, count);
    fmi3GetUInt8(instance, vr, n, booleans, count);
    fmi3SetString(instance, vr, n, reals, count);
    fmi3GetBinary(instance, vr, n, NULL, reals, count);
    fmi3SetClock(instance, vr, n, booleans);
}

int main(void)
{
    const fmi3ValueReference unknown = (fmi3ValueReference)Frama_C_interval(1000, INT32_MAX);
    sh_instance instance = any_instance();
    size_t i;

    access(NULL, NULL, 0, 0, 0);
    access(&instance, NULL, 0, 0, 0);
    access(&instance, NULL, 0, 0, Frama_C_size_t_interval(1, SIZE_MAX));
    access(&instance, &unknown, 1, 0, Frama_C_size_t_interval(0, SIZE_MAX));
    //@ loop unroll 20;
    for (i = 0; i < sizeof EVERY_KIND / sizeof EVERY_KIND[0]; ++i) {
        const fmi3ValueReference r = EVERY_KIND[i];
        const size_t own = r < sh_fmu_model.count ? sh_fmu_model.variables[r].length : 1;
        const fmi3ValueReference both[2] = {r, 0};

        access(&instance, &r, 1, own, own);
        access(&instance, both, 2, own + 1, own + 1);
        access(&instance, &r, 1, 0, Frama_C_size_t_interval(own + 1, SIZE_MAX));
    }
    return 0;
}
