/* Prints the first numbers of channel 0 of the noise of the Modelica package: seed, how many. */
#include <stdio.h>
#include <stdlib.h>

double sigmahat_standard_normal(int seed, int k, int channel);

int main(int count, char **arguments)
{
    int k;

    if (count != 3)
        return 2;
    for (k = 0; k < atoi(arguments[2]); ++k)
        printf("%a\n", sigmahat_standard_normal(atoi(arguments[1]), k, 0));
    return 0;
}
