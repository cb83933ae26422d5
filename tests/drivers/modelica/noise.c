/* Prints the first numbers of the noise of the Modelica package: seed, channel, how many. */
#include <stdio.h>
#include <stdlib.h>

double sigmahat_standard_normal(int seed, int k, int channel);

int main(int count, char **arguments)
{
    int k;

    if (count != 4) {
        return 2;
    }
    for (k = 0; k < atoi(arguments[3]); ++k) {
        printf("%a\n", sigmahat_standard_normal(atoi(arguments[1]), k, atoi(arguments[2])));
    }
    return 0;
}
