//! The words of a scene are found by what they are called, mean and may be.

use stationary::program::words;

fn places(query: &[&str]) -> Vec<String> {
    let query: Vec<String> = query.iter().map(|part| (*part).to_owned()).collect();
    words(&query).into_iter().map(|word| word.place).collect()
}

#[test]
fn a_word_is_found_by_its_name_wherever_it_stands() {
    assert!(places(&["friction"]).contains(&"contact.friction".to_owned()));
    assert!(places(&["mass"]).contains(&"bodies[].mass".to_owned()), "{:?}", places(&["mass"]));
}

#[test]
fn a_word_is_found_by_what_it_may_be() {
    assert_eq!(places(&["stormer-verlet"]), ["integrator"]);
}

#[test]
fn every_part_of_a_question_counts_and_case_does_not() {
    let both = places(&["Young", "solids"]);
    assert!(both.contains(&"solids[].young".to_owned()), "{both:?}");
    assert!(both.len() < places(&["young"]).len() + places(&["solids"]).len());
}

#[test]
fn without_a_question_stand_the_words_at_the_top_of_a_file() {
    let all = places(&[]);
    assert!(all.contains(&"integrator".to_owned()) && all.contains(&"bodies".to_owned()));
    assert!(all.iter().all(|place| !place.contains('.')));
}

#[test]
fn what_no_scene_can_say_is_not_found() {
    assert!(places(&["perpetual motion machine"]).is_empty());
}
